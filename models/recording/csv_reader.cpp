#include "models/recording/csv_reader.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "models/error.hpp"
#include "models/recording/csv_body.hpp"
#include "models/recording/csv_layout.hpp"
#include "models/recording/recording_checks.hpp"
#include "models/recording/text_file.hpp"

namespace wems {
namespace {

constexpr const char* kTime = "time";

/// What the header row says: which columns are read and as what.
class HeaderReader {
public:
    HeaderReader(const CsvLayout& layout, const std::string& file, const ColumnMap* map)
        : layout_(layout), file_(file), map_(map) {}

    void read(Recording& recording, std::vector<CsvColumn>& columns) {
        for (std::size_t i = 0; i < layout_.headers.size(); ++i) readColumn(static_cast<int>(i), recording, columns);
        checkMapUsed();
        const bool numbered = map_ != nullptr && !map_->has_time;
        if (!numbered && names_.count(kTime) == 0) {
            throw InputError({file_, layout_.header_row, kTime}, "there is no time column",
                             "`time [s]`, or a column map that names it or says time = \"none\"");
        }
        if (recording.channels.empty()) {
            throw InputError({file_, layout_.header_row, {}}, "no column is a channel",
                             "mobile.<connection>.x [mm], load.fz [N] and the like, or a column map");
        }
    }

private:
    void readColumn(int index, Recording& recording, std::vector<CsvColumn>& columns) {
        const auto& text = layout_.headers[static_cast<std::size_t>(index)];
        const MappedColumn* mapped = findMapped(text);
        const CsvHeader header = parseCsvHeader(text, mapped != nullptr);
        const std::string& name = mapped != nullptr ? mapped->channel : header.name;
        const auto channel = parseChannelName(name);
        const bool ignored_time = name == kTime && map_ != nullptr && !map_->has_time;
        if ((!channel && name != kTime) || ignored_time) {
            recording.unused_columns.push_back(text);
            return;
        }
        const InputLocation location{file_, layout_.header_row, name};
        if (!names_.insert(name).second) throw InputError(location, "there are two columns of this name");
        const Quantity quantity = channel ? findQuantity(*channel) : Quantity::time;
        const bool unit_in_map = mapped != nullptr && !mapped->unit.empty();
        if (!header.has_unit && !unit_in_map) {
            throw InputError(location, "column '" + text + "' has no unit",
                             name + " [" + siUnit(quantity) + "]; units: " + listUnits(quantity));
        }
        const std::string& unit = unit_in_map ? mapped->unit : header.unit;
        const double factor = findUnitFactor(unit, quantity, location);

        CsvColumn column;
        column.index = index;
        column.name = name;
        column.scale = mapped != nullptr ? mapped->scale * factor : factor;
        column.offset = mapped != nullptr ? mapped->offset * factor : 0.0;
        columns.push_back(std::move(column));
        if (channel) recording.channels.push_back({name, unit, {}, index + 1});
    }

    const MappedColumn* findMapped(const std::string& header) {
        if (map_ == nullptr) return nullptr;
        for (const auto& candidate : map_->columns) {
            if (candidate.column != header && candidate.column != parseCsvHeader(header, true).name) continue;
            used_.insert(&candidate);
            return &candidate;
        }
        return nullptr;
    }

    void checkMapUsed() const {
        if (map_ == nullptr) return;
        for (const auto& column : map_->columns) {
            if (used_.count(&column) != 0) continue;
            std::string present;
            for (const auto& header : layout_.headers) present += (present.empty() ? "" : ", ") + header;
            throw InputError({map_->file, column.line, column.column}, "there is no such column in " + file_,
                             present.size() > 300 ? present.substr(0, 300) + " …" : present);
        }
    }

    const CsvLayout& layout_;
    const std::string& file_;
    const ColumnMap* map_;
    std::set<std::string> names_;
    std::set<const MappedColumn*> used_;
};

/// Empty fields are left to the repair, but for time.
void checkFinite(const CsvColumn& column, bool is_time, const Recording& recording) {
    for (std::size_t i = 0; i < column.values.size(); ++i) {
        const InputLocation location{recording.file, recording.first_row + static_cast<long>(i), column.name};
        if (std::isinf(column.values[i])) throw InputError(location, "the value is too large");
        if (is_time && std::isnan(column.values[i])) throw InputError(location, "the row has no time");
    }
}

void takeColumns(std::vector<CsvColumn>& columns, const ColumnMap* map, Recording& recording) {
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
    if (map != nullptr && !map->has_time) {
        recording.time.resize(recording.channels.front().values.size());
        for (std::size_t i = 0; i < recording.time.size(); ++i)
            recording.time[i] = static_cast<double>(i) * map->sample_interval;
    }
}

}  // namespace

Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map) {
    CsvLayout layout = readCsvLayout(text, file, map);
    Recording recording;
    recording.file = file;
    recording.metadata = std::move(layout.metadata);
    recording.first_row = layout.firstRow();
    std::vector<CsvColumn> columns;
    HeaderReader(layout, file, map).read(recording, columns);
    readCsvBody(layout, file, columns);
    takeColumns(columns, map, recording);
    for (auto& finding : repairAndCheck(recording)) recording.warnings.push_back(std::move(finding.message));
    return recording;
}

Recording readRecording(const std::string& file, const ColumnMap* map) {
    const TextFile text(file);
    return parseRecording(text.view(), file, map);
}

}  // namespace wems
