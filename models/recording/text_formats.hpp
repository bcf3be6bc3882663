/// @file
/// The text formats other than CSV, each told once: what a file is, how it is read, and what the name of a file
/// promises follow from this table.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "models/recording/recording_table.hpp"
#include "models/recording/row_source.hpp"

namespace wems {

struct TextFormat {
    /// True if a text begins as a file of this format does.
    bool (*recognises)(std::string_view text);
    /// @throws InputError with file and line
    RecordingTable (*read)(std::string_view text, const std::string& file);
    /// The same row by row, for recordings longer than memory.
    std::unique_ptr<RowSource> (*open)(const std::string& file, const ColumnMap* map);
    std::vector<std::string> extensions;  ///< that promise this format, in lower case; may be none
    const char* beginning;                ///< how a file begins, for the message about one that does not
};

/// In the order in which they are tried.
const std::vector<TextFormat>& textFormats();

/// The format that a text begins as; nullptr if it is none of them.
const TextFormat* findTextFormat(std::string_view text);

}  // namespace wems
