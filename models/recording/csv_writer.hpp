/// @file
/// Recordings to CSV files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/recording/recording_writer.hpp"

namespace wems {

/// Writes metadata lines, a header row and the samples: comma, decimal point, LF. Values are written in the channel's
/// unit (SI if it has none) with `digits` significant digits, time in s with at least 12; NaN becomes an empty field.
/// It reads back to the same numbers to the digits printed.
class CsvWriter : public RecordingWriter {
public:
    /// @param digits 1 to 17
    /// Exceptions as openRecordingWriter().
    CsvWriter(const Recording& header, const std::string& file, int digits);

    void append(const Recording& rows) override;
    std::unique_ptr<AtomicFile> finish() override;

private:
    int digits_;
    std::vector<double> unit_factors_;  // one for each channel
    std::unique_ptr<AtomicFile> file_;
};

/// A whole recording. The file is complete or not there. Exceptions as writeRecording().
void writeCsv(const Recording& recording, const std::string& file, int digits = 9);

}  // namespace wems
