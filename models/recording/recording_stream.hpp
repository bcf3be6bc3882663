/// @file
/// A recording that is too long for memory, in blocks of consecutive rows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/recording/recording_table.hpp"
#include "models/recording/row_source.hpp"

namespace wems {

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
