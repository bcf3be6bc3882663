/// @file
/// A recording that is too long for memory, in blocks of consecutive rows.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

// Where RecordingStream takes its rows from.

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

/// Reads a file (isStreamable) front to back, a few megabytes of it in memory at a time.
///
/// Each block is a recording of its own, converted, checked and repaired as readRecording() does with a whole one, but
/// that it begins with the last row of the block before, so that gaps, repeated stamps and stamps that go back are seen
/// where blocks meet. What is found of the whole recording (a clipped or a constant channel) is found of the block.
class RecordingStream {
public:
    /// Reads the header.
    /// @param block_rows rows of a block; the last one has 2 to 1.5 · block_rows, at least half of them unless the
    ///                   recording is shorter
    /// @param map must outlive the stream; may be null
    /// @throws InputError as readRecording()
    RecordingStream(const std::string& file, const ColumnMap* map, std::size_t block_rows);

    /// Names and units of the channels, no values.
    const Recording& header() const { return source_->header(); }
    /// Samples of the whole recording, from the length of its first rows.
    double expectedSamples() const { return source_->expectedSamples(); }

    /// Part of the expected samples that the blocks so far hold, at most 1.
    double fractionRead() const;

    /// The next block; false after the last one. Notes on the header come with the first block.
    /// @throws InputError as readRecording(); a channel that has values in some blocks only
    bool next(Recording& block);

private:
    std::size_t pendingRows() const;
    void cutBlock(std::size_t rows, Recording& block);
    void checkSameChannels(const Recording& block);

    std::string file_;
    const ColumnMap* map_;
    std::size_t block_rows_;
    std::unique_ptr<RowSource> source_;
    Recording pending_;  // the rows that no block has had yet, and the last one of those that had
    BlockState state_;
    bool is_first_ = true;
    std::vector<std::string> channels_;  // of the first block
};

}  // namespace wems
