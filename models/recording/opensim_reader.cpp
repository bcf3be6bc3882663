#include "models/recording/opensim_reader.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"
#include "models/recording/line_cursor.hpp"

namespace wems {

namespace {

constexpr const char* kSimmRows = "datarows";

std::string_view trimLine(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    return first == std::string_view::npos ? std::string_view{}
                                           : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Fields of a row in which none may be empty: some programs put several tabs between them.
std::vector<std::string_view> splitSettings(std::string_view line) {
    auto fields = splitFields(line);
    fields.erase(std::remove_if(fields.begin(), fields.end(), [](std::string_view field) { return field.empty(); }),
                 fields.end());
    return fields;
}

/// The table of marker names under the four lines of a .trc header.
void readMarkerNames(LineCursor& lines, const std::string& unit, RecordingTable& table) {
    const auto names = splitFields(lines.take());
    table.header_row = lines.line();
    if (names.size() < 3 || names[0] != "Frame#" || names[1] != "Time")
        throw InputError({table.file, lines.line(), {}}, "the row of marker names does not begin with Frame# and Time",
                         "Frame#, Time, then each marker's name followed by two empty fields");
    table.columns = {{"frame", std::string("-"), {}}, {"time", std::string("s"), {"Time"}}};
    for (std::size_t i = 2; i < names.size(); ++i) {
        if (names[i].empty()) continue;
        const std::string marker(names[i]);
        for (const char* axis : kAxes) {
            const std::string upper(1, static_cast<char>(*axis - 'a' + 'A'));
            table.columns.push_back({marker + "." + axis, unit, {marker + "_" + axis, marker + "_" + upper}});
        }
    }
    lines.take();  // X1 Y1 Z1 …
}

/// Labels of a storage file, each as many columns as an element of its type has numbers.
void readLabels(std::string_view line, const std::string& type, RecordingTable& table) {
    std::size_t numbers = 1;
    bool vector = false;
    if (type == "Vec3") {
        numbers = 3;
        vector = true;
    } else if (type == "Quaternion") {
        numbers = 4;
    } else if (type == "SpatialVec" || type == "Vec6") {
        numbers = 6;
    } else if (!type.empty() && type != "double") {
        throw InputError({table.file, 0, "DataType"}, "'" + type + "' is not read",
                         "double, Vec3, Quaternion, SpatialVec, Vec6");
    }
    for (const auto field : splitFields(line)) {
        if (field.empty()) continue;
        const std::string label(field);
        if (table.columns.empty() || numbers == 1) {
            table.columns.push_back({label, {}, {}});
            continue;
        }
        for (std::size_t k = 0; k < numbers; ++k)
            table.columns.push_back({label + "." + (vector ? kAxes[k] : std::to_string(k + 1)), {}, {}});
    }
    if (table.columns.size() < 2)
        throw InputError({table.file, table.header_row, {}}, "there are no column labels after endheader",
                         "time and other labels, separated by tabs");
}

/// Our own writer says that everything is SI.
void stateUnits(RecordingTable& table) {
    for (OfferedColumn& column : table.columns) {
        const auto channel = parseChannelName(column.text);
        if (channel) column.unit = siUnit(findQuantity(*channel));
        if (column.text == "time") column.unit = siUnit(Quantity::time);
    }
}

std::optional<double> findDeclaredRows(const Metadata& metadata) {
    for (const char* key : {"nRows", "NumFrames", kSimmRows}) {
        const auto found = metadata.find(key);
        if (found == metadata.end()) continue;
        char* end = nullptr;
        const double rows = std::strtod(found->second.c_str(), &end);
        if (end != found->second.c_str() && rows >= 0) return rows;
    }
    return std::nullopt;
}

void checkEnd(RecordingTable& table, const LineCursor& lines, std::string_view text) {
    checkRowCount(table.file, table.metadata, lines.line(), table.values.empty() ? 0 : table.values.front().size());
    if (text.back() != '\n') table.warnings.emplace_back(kNoLineEnd);
}

}  // namespace

void checkRowCount(const std::string& file, const Metadata& metadata, long last_line, std::size_t rows) {
    const std::optional<double> declared = findDeclaredRows(metadata);
    if (!declared || static_cast<double>(rows) == *declared) return;
    throw InputError(
        {file, last_line, {}},
        "the file ends after " + std::to_string(rows) + " rows, its header declares " + formatNumber(*declared),
        "a file that is complete, or the right number in the header");
}

bool isTrc(std::string_view text) {
    return text.substr(0, 12) == "PathFileType";
}

bool isStorage(std::string_view text) {
    LineCursor lines(text.substr(0, 65536));
    for (int i = 0; i < 200 && !lines.atEnd(); ++i) {
        if (trimLine(lines.take()) == "endheader") return true;
    }
    return false;
}

RecordingTable readTrcHeader(LineCursor& lines, const std::string& file) {
    RecordingTable table;
    table.file = file;
    table.format = "OpenSim .trc";
    table.positions = true;
    const auto path = splitFields(lines.take());
    if (path.size() >= 3 && path[2] != "(X/Y/Z)")
        throw InputError({file, 1, "PathFileType"}, "the order of the axes is '" + std::string(path[2]) + "'",
                         "(X/Y/Z)");
    const auto keys = splitSettings(lines.take());
    const auto settings = splitSettings(lines.take());
    std::string unit;
    for (std::size_t i = 0; i < std::min(keys.size(), settings.size()); ++i) {
        table.metadata[std::string(keys[i])] = std::string(settings[i]);
        if (keys[i] == "Units") unit = settings[i];
    }
    if (unit.empty()) throw InputError({file, lines.line(), "Units"}, "the header states no unit", "m, mm");
    readMarkerNames(lines, unit, table);
    while (!lines.atEnd() && trimLine(lines.rest().substr(0, lines.rest().find('\n'))).empty()) lines.take();
    table.first_row = lines.line() + 1;
    if (lines.atEnd()) throw InputError({file, lines.line(), {}}, "no data rows after the header");
    return table;
}

RecordingTable readStorageHeader(LineCursor& lines, const std::string& file) {
    RecordingTable table;
    table.file = file;
    table.format = "OpenSim .sto";
    table.missing_unit = MissingUnit::si;
    std::string type;
    for (;;) {
        if (lines.atEnd()) throw InputError({file, 0, {}}, "there is no line `endheader`");
        const auto line = trimLine(lines.take());
        if (line == "endheader") break;
        const auto equals = line.find('=');
        if (equals == std::string_view::npos) {
            const auto words = splitFields(line);  // SIMM's motion files
            if (words.size() == 2 && words[0] == kSimmRows) table.metadata[kSimmRows] = std::string(words[1]);
            continue;
        }
        const std::string key(trimLine(line.substr(0, equals)));
        table.metadata[key] = std::string(trimLine(line.substr(equals + 1)));
        if (key == "DataType") type = table.metadata[key];
    }
    std::string_view labels;
    while (!lines.atEnd() && trimLine(labels).empty()) labels = lines.take();
    table.header_row = lines.line();
    readLabels(labels, type, table);
    if (table.metadata["units"] == "SI") stateUnits(table);
    table.first_row = lines.line() + 1;
    return table;
}

RecordingTable readTrc(std::string_view text, const std::string& file) {
    LineCursor lines(text);
    RecordingTable table = readTrcHeader(lines, file);
    table.values = readNumberRows(lines, table.columns.size(), file);
    checkEnd(table, lines, text);
    return table;
}

RecordingTable readStorage(std::string_view text, const std::string& file) {
    LineCursor lines(text);
    RecordingTable table = readStorageHeader(lines, file);
    table.values = readNumberRows(lines, table.columns.size(), file);
    checkEnd(table, lines, text);
    return table;
}

OpensimRows::OpensimRows(const std::string& file, const ColumnMap* map)
    : text_(file, TextFile::Pages::as_needed), lines_(skipByteOrderMark(text_.view())) {
    RecordingTable table = isTrc(lines_.rest()) ? readTrcHeader(lines_, file) : readStorageHeader(lines_, file);
    column_count_ = table.columns.size();
    plan_ = planTable(table, map);
    if (text_.view().back() != '\n') plan_.recording.warnings.emplace_back(kNoLineEnd);
    expected_samples_ = estimateRows(lines_.rest());
}

bool OpensimRows::append(Recording& rows) {
    if (lines_.atEnd()) {
        checkRowCount(plan_.recording.file, plan_.recording.metadata, lines_.line(), rows_read_);
        return false;
    }
    auto values = readNumberRows(lines_, column_count_, plan_.recording.file, kRowsAtOnce);
    rows_read_ += values.front().size();
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, std::move(values[plan_.columns[k].index]), rows);
    text_.release();
    return true;
}

}  // namespace wems
