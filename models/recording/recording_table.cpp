#include "models/recording/recording_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "models/recording/recording_checks.hpp"

namespace wems {
namespace {

/// Empty fields are left to the repair, but for time.
void checkValues(const std::vector<double>& values, const std::string& name, const Recording& recording,
                 std::size_t before) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue;
        const InputLocation location{recording.file, recording.first_row + static_cast<long>(before + i), name};
        if (std::isinf(values[i])) throw InputError(location, "the value is not finite");
        if (name == "time" && std::isnan(values[i])) throw InputError(location, "the row has no time");
    }
}

std::string joinNames(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < 4; ++i) text += (i > 0 ? ", " : "") + names[i];
    return names.size() > 4 ? text + " and " + std::to_string(names.size() - 4) + " more" : text;
}

/// Mean over the first `duration` seconds of every displacement channel, 0 of others; 0 s: the first value that is
/// there.
std::vector<double> calcRest(const Recording& recording, double duration) {
    std::vector<double> rest(recording.channels.size(), 0.0);
    for (std::size_t c = 0; c < rest.size(); ++c) {
        const Channel& channel = recording.channels[c];
        const auto name = parseChannelName(channel.name);
        if (!name || name->derivative != Derivative::displacement) continue;
        double sum = 0, count = 0;
        for (std::size_t i = 0; i < channel.values.size(); ++i) {
            if (recording.time[i] - recording.time.front() > duration && count > 0) break;
            if (std::isnan(channel.values[i])) continue;
            sum += channel.values[i];
            count += 1;
        }
        if (count > 0) rest[c] = sum / count;
    }
    return rest;
}

void noteRest(Recording& recording, const std::vector<double>& rest, double duration) {
    double largest = 0;
    for (const double value : rest) largest = std::max(largest, std::abs(value));
    if (largest == 0) return;
    char text[160];
    if (duration > 0) {
        std::snprintf(text, sizeof text,
                      "displacements count from the mean position of the first %g s (up to %.4g m from the origin)",
                      duration, largest);
    } else {
        std::snprintf(
            text, sizeof text,
            "displacements count from the position in the first row (up to %.4g m from the origin); `rest` in "
            "the column map sets another",
            largest);
    }
    recording.warnings.emplace_back(text);
}

/// No measurement is larger; fourth powers of what is left are finite numbers.
constexpr double kLargestValue = 1e75;

void checkMagnitudes(const Recording& block) {
    const auto check = [&](const std::vector<double>& values, const std::string& name) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!(std::abs(values[i]) > kLargestValue)) continue;
            char text[40];
            std::snprintf(text, sizeof text, "the value is %.3g in SI", values[i]);
            throw InputError({block.file, block.first_row + static_cast<long>(i), name}, text,
                             "a measured value, up to 1e75");
        }
    };
    check(block.time, "time");
    for (const Channel& channel : block.channels) check(channel.values, channel.name);
}

}  // namespace

void finishBlock(Recording& block, const ColumnMap* map, bool positions, BlockState& state) {
    if (map != nullptr && !map->has_time) {
        block.time.resize(block.channels.front().values.size());
        for (std::size_t i = 0; i < block.time.size(); ++i)
            block.time[i] = static_cast<double>(state.first_sample + i) * map->sample_interval;
    }
    checkMagnitudes(block);
    const RestPosition kind = map != nullptr ? map->rest : RestPosition{};
    if (kind.kind == RestPosition::Kind::mean || (positions && kind.kind == RestPosition::Kind::by_format)) {
        if (!state.rest) {
            state.rest = calcRest(block, kind.duration);
            noteRest(block, *state.rest, kind.duration);
        }
        for (std::size_t c = 0; c < block.channels.size(); ++c)
            for (double& value : block.channels[c].values) value -= (*state.rest)[c];
    }
    block.findings = repairAndCheck(block);
    for (const auto& finding : block.findings) block.warnings.push_back(finding.message);
}

void finishRecording(Recording& recording, const ColumnMap* map, bool positions) {
    BlockState alone;
    finishBlock(recording, map, positions, alone);
}

namespace {

/// Names of some writers are in the code page of their computer.
void decodeNames(RecordingTable& table) {
    for (OfferedColumn& column : table.columns) {
        column.text = decodeLatin1(column.text);
        if (column.unit) column.unit = decodeLatin1(*column.unit);
        for (auto& alias : column.aliases) alias = decodeLatin1(alias);
    }
    std::map<std::string, std::string> metadata;
    for (const auto& [key, value] : table.metadata) metadata[decodeLatin1(key)] = decodeLatin1(value);
    table.metadata = std::move(metadata);
    for (auto& warning : table.warnings) warning = decodeLatin1(warning);
}

}  // namespace

TablePlan planTable(RecordingTable& table, const ColumnMap* map) {
    decodeNames(table);
    ColumnSelection selection = selectColumns(table.columns, table.file, table.header_row, map, table.missing_unit);
    TablePlan plan;
    Recording& recording = plan.recording;
    recording.file = std::move(table.file);
    recording.format = std::move(table.format);
    recording.metadata = std::move(table.metadata);
    recording.unused_columns = std::move(selection.unused);
    recording.warnings = std::move(table.warnings);
    recording.first_row = table.first_row;
    if (!selection.without_unit.empty())
        recording.warnings.push_back("the file states no unit of " + joinNames(selection.without_unit) +
                                     "; SI is assumed");
    for (const auto& column : selection.columns) {
        if (column.name == kTime) continue;
        recording.channels.push_back({column.name, column.unit, {}, static_cast<int>(column.index) + 1});
    }
    plan.columns = std::move(selection.columns);
    plan.positions = table.positions;
    return plan;
}

std::size_t checkLengths(const TablePlan& plan, const std::function<std::size_t(const SelectedColumn&)>& count) {
    const auto& columns = plan.columns;
    auto first =
        std::find_if(columns.begin(), columns.end(), [](const SelectedColumn& column) { return column.name == kTime; });
    if (first == columns.end()) first = columns.begin();
    const std::size_t length = count(*first);
    for (const SelectedColumn& column : columns) {
        if (count(column) == length) continue;
        throw InputError({plan.recording.file, 0, column.name},
                         "has " + std::to_string(count(column)) + " values, the time has " + std::to_string(length),
                         "channels of one length; a column map can choose among them, and `identify merge` puts "
                         "recordings of different rates together");
    }
    return length;
}

void appendValues(const TablePlan& plan, std::size_t k, std::vector<double> values, Recording& recording) {
    const SelectedColumn& column = plan.columns[k];
    std::size_t channel = 0;
    for (std::size_t j = 0; j < k; ++j) channel += plan.columns[j].name == kTime ? 0U : 1U;
    std::vector<double>& target = column.name == kTime ? recording.time : recording.channels[channel].values;
    for (double& value : values) value = column.scale * value + column.offset;
    checkValues(values, column.name, recording, target.size());
    if (target.empty()) {
        target = std::move(values);
    } else {
        target.insert(target.end(), values.begin(), values.end());
    }
}

Recording makeRecording(RecordingTable table, const ColumnMap* map) {
    TablePlan plan = planTable(table, map);
    Recording& recording = plan.recording;
    const std::size_t length =
        checkLengths(plan, [&](const SelectedColumn& column) { return table.values[column.index].size(); });
    for (std::size_t k = 0; k < plan.columns.size(); ++k)
        appendValues(plan, k, std::move(table.values[plan.columns[k].index]), recording);
    if (length == 0) throw InputError({recording.file, table.header_row, {}}, "there are no samples");
    finishRecording(recording, map, plan.positions);
    return std::move(plan.recording);
}

}  // namespace wems
