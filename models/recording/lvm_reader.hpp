/// @file
/// LabVIEW's text measurement file, `.lvm`: a header of the file, one of its segment, and rows.
///
/// Columns bear the names of the row that begins with `X_Value`, units those of `Y_Unit_Label`. The time is that of the
/// first column (`X_Columns` One), of each channel (Multi, which must agree), or X0 and Delta_X of all channels (No).
/// The decimal separator is the one that the header states, a point without; the comment behind the numbers of a row is
/// not read. A file of several segments is refused: between them the clock may have stood still. Where rows without
/// times are more than `Samples`, several packets stand on end under one header, which is taken as one run and noted.
///
/// Source: National Instruments, Specification for the LabVIEW Measurement File (.lvm).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "models/common/text_file.hpp"
#include "models/recording/line_cursor.hpp"
#include "models/recording/recording_stream.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

/// True if `text` begins as such a file does.
bool isLvm(std::string_view text);

/// How the rows of a segment are written.
struct LvmRowForm {
    enum class Times { none, first, each } times = Times::first;  ///< X_Columns
    char separator = '\t', decimal = '.';
    std::size_t channels = 0;
    double start = 0, interval = 0;  ///< s, where no row holds its time
    std::size_t packet = 0;          ///< rows written at once, where no row holds its time; 0 if that is not stated

    /// Field of a channel's value in a row, and in the rows of the segment's header.
    std::size_t fieldOf(std::size_t channel) const { return 1 + (times == Times::each ? 2 : 1) * channel; }
};

struct LvmHeader {
    RecordingTable table;  ///< time, then the channels; no values
    LvmRowForm form;
};

/// What stands before the rows; `lines` is left at the first one.
/// @throws InputError with file and line
LvmHeader readLvmHeader(LineCursor& lines, const std::string& file);

/// Rows of numbers into the columns of the header's table; NaN where a field is empty.
/// @param first_sample number of the first row that is read, from 0
/// @param most rows that are read; the cursor then stands at the next one
/// @throws InputError with file and line: not a number, times that differ between channels, a further segment
std::vector<std::vector<double>> readLvmRows(LineCursor& lines, const LvmRowForm& form, const std::string& file,
                                             std::size_t first_sample = 0,
                                             std::size_t most = static_cast<std::size_t>(-1));

/// The note on rows beyond the first packet.
std::string describePackets(const LvmRowForm& form);

/// Header and rows.
/// @throws InputError with file and line
RecordingTable readLvm(std::string_view text, const std::string& file);

// Rows of LabVIEW's text measurement file.

/// A `.lvm`, a few thousand rows at a time.
class LvmRows : public RowSource {
public:
    LvmRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return expected_samples_; }
    bool append(Recording& rows) override;

private:
    bool exceedsPacket() const;

    TextFile text_;
    LineCursor lines_;
    LvmRowForm form_;
    TablePlan plan_;
    double expected_samples_ = 0;
    std::size_t samples_read_ = 0;
};

}  // namespace wems
