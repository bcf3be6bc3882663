/// @file
/// Where RecordingStream takes its rows from.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// Rows that a source of text takes at a time.
inline constexpr std::size_t kRowsAtOnce = 4096;

/// The rows of a file, front to back, in memory that does not grow with the file.
class RowSource {
public:
    RowSource() = default;
    virtual ~RowSource() = default;
    RowSource(const RowSource&) = delete;
    RowSource& operator=(const RowSource&) = delete;

    /// Names and units of the channels, no values.
    virtual const Recording& header() const = 0;
    /// Of the whole file, as far as its first rows tell.
    virtual double expectedSamples() const = 0;
    /// Displacement channels are positions: their rest is taken off.
    virtual bool hasPositions() const { return false; }
    /// Reads on and appends values in SI to `rows`, which has the header's channels; false at the end of the file.
    /// @throws InputError as readRecording()
    virtual bool append(Recording& rows) = 0;
};

/// @param map must outlive the source; may be null
/// @throws InputError as readRecording() for what stands before the rows
std::unique_ptr<RowSource> openRows(const std::string& file, const ColumnMap* map);

}  // namespace wems
