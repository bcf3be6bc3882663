#include "models/recording/csv_reader.hpp"

#include <cmath>

#include "models/error.hpp"
#include "models/recording/column_selection.hpp"
#include "models/recording/csv_body.hpp"
#include "models/recording/csv_layout.hpp"
#include "models/recording/recording_table.hpp"
#include "models/recording/utf8.hpp"

namespace wems {
namespace {

constexpr const char* kTime = "time";

std::vector<OfferedColumn> listColumns(const CsvLayout& layout) {
    std::vector<OfferedColumn> offered;
    offered.reserve(layout.headers.size());
    for (std::size_t i = 0; i < layout.headers.size(); ++i) {
        OfferedColumn column{layout.headers[i], {}, {}};
        if (!layout.units.empty() && !layout.units[i].empty()) column.unit = layout.units[i];
        offered.push_back(std::move(column));
    }
    return offered;
}

/// Empty fields are left to the repair, but for time.
void checkFinite(const CsvColumn& column, bool is_time, const Recording& recording) {
    for (std::size_t i = 0; i < column.values.size(); ++i) {
        const InputLocation location{recording.file, recording.first_row + static_cast<long>(i), column.name};
        if (std::isinf(column.values[i])) throw InputError(location, "the value is too large");
        if (is_time && std::isnan(column.values[i])) throw InputError(location, "the row has no time");
    }
}

void takeColumns(std::vector<CsvColumn>& columns, Recording& recording) {
    std::size_t next = 0;
    for (auto& column : columns) {
        const bool is_time = column.name == kTime;
        if (column.has_non_finite) checkFinite(column, is_time, recording);
        if (is_time) {
            recording.time = std::move(column.values);
        } else {
            recording.channels[next++].values = std::move(column.values);
        }
    }
}

}  // namespace

Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map) {
    // Spreadsheets' "Unicode text".
    if (const std::string decoded = decodeUtf16(text); !decoded.empty()) return parseRecording(decoded, file, map);
    CsvLayout layout = readCsvLayout(text, file, map);
    Recording recording;
    recording.file = file;
    recording.format = "CSV";
    recording.metadata = std::move(layout.metadata);
    recording.first_row = layout.first_row;
    recording.warnings = std::move(layout.warnings);
    auto selection = selectColumns(listColumns(layout), file, layout.header_row, map, MissingUnit::error);
    recording.unused_columns = std::move(selection.unused);
    std::vector<CsvColumn> columns;
    for (auto& selected : selection.columns) {
        CsvColumn column;
        column.index = static_cast<int>(selected.index);
        column.name = selected.name;
        column.scale = selected.scale;
        column.offset = selected.offset;
        columns.push_back(std::move(column));
        if (selected.name == kTime) continue;
        recording.channels.push_back({selected.name, selected.unit, {}, static_cast<int>(selected.index) + 1});
    }
    readCsvBody(layout, file, columns);
    takeColumns(columns, recording);
    finishRecording(recording, map, false);
    return recording;
}

}  // namespace wems
