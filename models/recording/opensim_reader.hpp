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

#include <string>
#include <string_view>

#include "models/recording/line_cursor.hpp"
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

}  // namespace wems
