/// @file
/// Recordings to files: CSV, OpenSim .trc, .sto and .mot, by the file's extension.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "models/common/atomic_file.hpp"
#include "models/recording/recording.hpp"

namespace wems {

// Numbers of recordings as text: what the writers of text formats share.

inline constexpr int kTimeDigits = 12;                           // of the time column at least
inline constexpr std::size_t kFlushSize = std::size_t{1} << 20;  // bytes of text that are written at once

/// Appends with so many significant digits; nothing for a NaN, which is a gap. Throws std::invalid_argument if
/// infinite.
void appendNumber(double value, int digits, std::string& text);

/// The parts of the channel's name. Throws std::invalid_argument if it is none.
ChannelName parseValidName(const Channel& channel);
/// Throws std::invalid_argument unless there are so many channels, each as long as time.
void checkRows(const Recording& rows, std::size_t channel_count);

struct WriteOptions {
    int digits = 9;  ///< significant digits of values, 1 to 17; time has at least 12
    /// Rest positions in ground axes, m, by connection: .trc holds positions. A connection that is not here is at 0.
    std::map<std::string, Eigen::Vector3d> rest;
};

/// A recording on its way into a file, block by block: memory does not grow with its length.
class RecordingWriter {
public:
    RecordingWriter() = default;
    virtual ~RecordingWriter() = default;
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    /// Writes the samples of `rows`, which has the header's channels in their order.
    /// @throws InputError: the disk does not take them; std::invalid_argument: a channel whose length is not that of
    ///         time, a value that is infinite
    virtual void append(const Recording& rows) = 0;
    /// The file, complete; it appears with its commit().
    virtual std::unique_ptr<AtomicFile> finish() = 0;
    /// One sentence for each thing that the format cannot hold.
    const std::vector<std::string>& notes() const { return notes_; }

protected:
    std::vector<std::string> notes_;
};

/// What some formats say of the rows before the first of them.
struct RowPlan {
    std::size_t count = 0;
    double interval = 0;  ///< s, mean; 0: not known
};

/// @param header names and units of the channels, metadata; its samples are left alone
/// @throws InputError: the file cannot be written, a unit that is not known, nothing that the format can hold;
///         std::invalid_argument: a name that is no channel
std::unique_ptr<RecordingWriter> openRecordingWriter(const Recording& header, const RowPlan& plan,
                                                     const std::string& file, const WriteOptions& options);

/// A whole recording. The file is complete or not there.
/// @returns one sentence for each thing that the format cannot hold
/// @throws as openRecordingWriter() and RecordingWriter::append()
std::vector<std::string> writeRecording(const Recording& recording, const std::string& file,
                                        const WriteOptions& options = {});
/// The same as one of the files that a command writes.
std::vector<std::string> writeRecording(const Recording& recording, const std::string& file,
                                        const WriteOptions& options, OutputFiles& outputs);

// Recordings to CSV files.

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
