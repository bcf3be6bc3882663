/// @file
/// JSON tables: what web pages, notebooks and public data sets write.
///
/// An object of arrays is a table of columns: `{"time [s]": […], "force.1.z [N]": […]}`. A matrix, by itself or in an
/// object, is a table of rows: `{"data": [[…], …]}`, its columns called `data.1`, `data.2` …, or by a list of as many
/// names beside it, as in a MATLAB file (mat_reader.hpp). Numbers and texts become metadata, null a value that is
/// missing.
#pragma once

#include <string>
#include <string_view>

#include "models/recording/recording_table.hpp"

namespace wems {

/// True if a text begins as a JSON table does: with a brace, or with brackets before a number.
bool isJson(std::string_view text);

/// @throws InputError: not JSON, with its line; rows of different lengths; no numbers
RecordingTable readJson(std::string_view text, const std::string& file);

}  // namespace wems
