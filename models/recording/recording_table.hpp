/// @file
/// What the readers of the formats other than CSV hand over, and the last steps that all formats share.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems {

/// A file's columns as they stand in it. All that are used must be of one length.
struct RecordingTable {
    std::string file, format;
    std::map<std::string, std::string> metadata;
    std::vector<OfferedColumn> columns;
    std::vector<std::vector<double>> values;  ///< of each column; NaN where there is none
    MissingUnit missing_unit = MissingUnit::error;
    bool positions = false;  ///< displacement channels are positions: their rest is taken off
    long header_row = 0;     ///< 0 if the file has no rows
    long first_row = 1;      ///< of the first sample; the sample's number where the file has no rows
    std::vector<std::string> warnings;
};

/// The recording that a table becomes, as far as its header tells.
struct TablePlan {
    Recording recording;                  ///< names and units
    std::vector<SelectedColumn> columns;  ///< time and channels, in the table's order
    bool positions = false;               ///< as RecordingTable
};
/// @throws InputError as selectColumns()
TablePlan planTable(RecordingTable& table, const ColumnMap* map);

/// The number of samples that all columns of the plan have.
/// @param count of a column
/// @throws InputError: they have different ones
std::size_t checkLengths(const TablePlan& plan, const std::function<std::size_t(const SelectedColumn&)>& count);

/// Converts further values of column `k` of the plan to SI and appends them to `recording`.
/// @throws InputError: an infinite value, a row without time
void appendValues(const TablePlan& plan, std::size_t k, std::vector<double> values, Recording& recording);

/// Selects, converts to SI, checks and repairs (recording_checks.hpp).
/// @throws InputError
Recording makeRecording(RecordingTable table, const ColumnMap* map);

/// The last steps for a recording of SI values: the time where it is numbered, the rest position where the map (or the
/// format) says that displacements are positions, checks and repairs. `time` must be filled unless the map says that
/// there is none.
void finishRecording(Recording& recording, const ColumnMap* map, bool positions);

/// What the blocks of one recording share.
struct BlockState {
    std::size_t first_sample = 0;             ///< of the next block, counted from 0
    std::optional<std::vector<double>> rest;  ///< of each channel, set by the first block where one is taken off
};
/// The same for one block of a recording. @throws InputError also if rest reaches beyond the first block
void finishBlock(Recording& block, const ColumnMap* map, bool positions, BlockState& state);

}  // namespace wems
