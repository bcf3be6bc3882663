/// @file
/// A recording that is too long for memory, in blocks of consecutive rows.
#pragma once

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "models/recording/csv_reader.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

/// Reads a CSV file (isPlainCsv) front to back, a few megabytes of it in memory at a time.
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
    const Recording& header() const { return header_; }
    /// Samples of the whole recording, from the length of its first rows.
    double expectedSamples() const { return expected_samples_; }

    /// Part of the expected samples that the blocks so far hold, at most 1.
    double fractionRead() const {
        return std::min(1.0, static_cast<double>(state_.first_sample + 1) / expected_samples_);
    }

    /// The next block; false after the last one. Notes on the header come with the first block.
    /// @throws InputError as readRecording(); a channel that has values in some blocks only
    bool next(Recording& block);

private:
    std::string_view readRows();
    void parseRows();
    std::size_t pendingRows() const;
    void cutBlock(std::size_t rows, Recording& block);
    void checkSameChannels(const Recording& block);

    std::string file_;
    const ColumnMap* map_;
    std::size_t block_rows_;
    std::ifstream input_;
    std::string text_;             // read and not yet parsed
    std::size_t parsed_text_ = 0;  // bytes of text_ that were
    CsvPlan plan_;                 // its recording holds the rows that no block has had yet, and the last one of those
    Recording header_;
    BlockState state_;
    double expected_samples_ = 0;
    bool at_end_ = false;     // of the file
    bool past_rows_ = false;  // a blank row was read: no more may follow
    bool is_first_ = true;
    std::vector<std::string> channels_;  // of the first block
};

}  // namespace wems
