/// @file
/// OpenSim's text formats.
///
/// - `.trc` (Track Row Column, Motion Analysis): markers' positions. Coordinates are called `<marker>.x`, `.y`, `.z`; a
///   marker `mobile.1` is thus the connection's. Positions become displacements by taking the rest position off, which
///   is the first row unless the column map says otherwise (`rest`).
/// - `.sto` and `.mot` (storage, motion): tables under a header that ends with `endheader`; SI where no unit is stated.
///   Vectors (`DataType=Vec3`) give columns `<label>.x`, `.y`, `.z`, other elements of n numbers `<label>.1` to `.n`.
///
/// Sources: OpenSim documentation, Marker (.trc) Files; Storage (.sto) Files; Motion (.mot) Files.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "models/common/text_file.hpp"
#include "models/recording/line_cursor.hpp"
#include "models/recording/recording_stream.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

/// True if `text` begins as such a file does.
bool isTrc(std::string_view text);
bool isStorage(std::string_view text);

/// What stands before the rows; `lines` is left at the first one.
/// @throws InputError with file and line
RecordingTable readTrcHeader(LineCursor& lines, const std::string& file);
RecordingTable readStorageHeader(LineCursor& lines, const std::string& file);

/// Header and rows.
/// @throws InputError with file and line
RecordingTable readTrc(std::string_view text, const std::string& file);
RecordingTable readStorage(std::string_view text, const std::string& file);

using Metadata = std::map<std::string, std::string>;

/// @param metadata of the header, which may declare the rows (`nRows`, `NumFrames`, `datarows`)
/// @param last_line of the file, from 1
/// @throws InputError if there are not as many rows as declared
void checkRowCount(const std::string& file, const Metadata& metadata, long last_line, std::size_t rows);

/// Warning of a text whose last row has no line end.
inline constexpr const char* kNoLineEnd =
    "the last row has no line end: the file may be cut, and its last number may lack digits";

// Rows of OpenSim's text formats.

/// A `.trc`, `.sto` or `.mot`, a few thousand rows at a time.
class OpensimRows : public RowSource {
public:
    OpensimRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return expected_samples_; }
    bool hasPositions() const override { return plan_.positions; }
    bool append(Recording& rows) override;

private:
    TextFile text_;
    LineCursor lines_;
    TablePlan plan_;
    std::size_t column_count_ = 0;  // in the file
    std::size_t rows_read_ = 0;
    double expected_samples_ = 0;
};

}  // namespace wems
