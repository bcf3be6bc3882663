#include "models/recording/csv_reader.hpp"

#include <cmath>

#include "models/error.hpp"
#include "models/recording/column_selection.hpp"
#include "models/recording/recording_table.hpp"
#include "models/recording/utf8.hpp"

namespace wems {
namespace {

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
void checkFinite(const CsvColumn& column, const std::string& file, long first_row) {
    for (std::size_t i = 0; i < column.values.size(); ++i) {
        const InputLocation location{file, first_row + static_cast<long>(i), column.name};
        if (std::isinf(column.values[i])) throw InputError(location, "the value is too large");
        if (column.name == kTime && std::isnan(column.values[i])) throw InputError(location, "the row has no time");
    }
}

void append(std::vector<double>& more, std::vector<double>& values) {
    if (values.empty()) {
        values = std::move(more);
    } else {
        values.insert(values.end(), more.begin(), more.end());
    }
}

}  // namespace

CsvPlan planCsv(std::string_view text, const std::string& file, const ColumnMap* map) {
    CsvPlan plan;
    plan.layout = readCsvLayout(text, file, map);
    CsvLayout& layout = plan.layout;
    Recording& recording = plan.recording;
    recording.file = file;
    recording.format = "CSV";
    recording.metadata = std::move(layout.metadata);
    recording.first_row = layout.first_row;
    recording.warnings = std::move(layout.warnings);
    auto selection = selectColumns(listColumns(layout), file, layout.header_row, map, MissingUnit::error);
    recording.unused_columns = std::move(selection.unused);
    for (auto& selected : selection.columns) {
        CsvColumn column;
        column.index = static_cast<int>(selected.index);
        column.name = selected.name;
        column.scale = selected.scale;
        column.offset = selected.offset;
        plan.columns.push_back(std::move(column));
        if (selected.name == kTime) continue;
        recording.channels.push_back({selected.name, selected.unit, {}, static_cast<int>(selected.index) + 1});
    }
    return plan;
}

std::size_t appendRows(CsvPlan& plan, Recording& recording) {
    readCsvBody(plan.layout, recording.file, plan.columns);
    const std::size_t rows = plan.columns.front().values.size();
    std::size_t next = 0;
    for (auto& column : plan.columns) {
        if (column.has_non_finite) checkFinite(column, recording.file, plan.layout.first_row);
        column.has_non_finite = false;
        append(column.values, column.name == kTime ? recording.time : recording.channels[next++].values);
    }
    return rows;
}

Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map) {
    // Spreadsheets' "Unicode text".
    if (const std::string decoded = decodeUtf16(text); !decoded.empty()) return parseRecording(decoded, file, map);
    CsvPlan plan = planCsv(text, file, map);
    appendRows(plan, plan.recording);
    finishRecording(plan.recording, map, false);
    return std::move(plan.recording);
}

}  // namespace wems
