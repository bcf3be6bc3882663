/// @file
/// A recording that a command has written, as data and as a page with its channels over time.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/cli/command.hpp"
#include "models/recording/recording.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {

struct WrittenRecording {
    const Recording& recording;
    std::string file;                ///< as which it was written
    std::string made;                ///< one line: what it was made of
    std::vector<std::string> notes;  ///< what was noticed on the way
};

/// --json and --report, if they were asked for.
/// @param record of the command
/// @param pictures that come before those of the channels
void reportWritten(const WrittenRecording& written, const ResultRecord& record, const std::vector<Plot>& pictures,
                   const CommonOptions& options, OutputFiles& outputs);

}  // namespace wems::identify::cli
