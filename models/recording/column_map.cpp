#include "models/recording/column_map.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "models/common/toml_table.hpp"
#include "models/recording/csv_layout.hpp"
#include "models/recording/recording.hpp"

namespace wems {

namespace {

constexpr const char* kChannelNames =
    "time, mobile.<connection>.<q>, fixed.<connection>.<q>, relative.<connection>.<q> with <q> x y z vx vy vz ax ay "
    "az, "
    "force.<connection>.<x|y|z>, load.fx|fy|fz, base.ax|ay|az";

class MapReader {
public:
    explicit MapReader(const std::string& file) { map_.file = file; }

    ColumnMap read(const toml::table& root) {
        for (const auto& [key, node] : root) {
            const std::string name(key);
            const auto* table = node.as_table();
            if (name != "columns" && name != "table") fail(node, name, "unknown key", "columns, table");
            if (table == nullptr) fail(node, name, "must be a table");
            if (name == "columns") {
                readColumns(*table);
            } else {
                readShape(*table);
            }
        }
        if (map_.columns.empty()) {
            throw InputError({map_.file, 0, "columns"}, "no column is mapped", "\"header in the file\" = \"channel\"");
        }
        return std::move(map_);
    }

private:
    [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& problem,
                           const std::string& accepted = {}) const {
        throw InputError({map_.file, static_cast<long>(node.source().begin.line), key}, problem, accepted);
    }

    std::string readText(const toml::node& node, const std::string& key) const {
        const auto text = node.value_exact<std::string>();
        if (!text) fail(node, key, "must be text in quotes");
        return *text;
    }

    double readNumber(const toml::node& node, const std::string& key) const {
        const auto number = node.is_number() ? node.value<double>() : std::nullopt;
        if (!number || !std::isfinite(*number)) fail(node, key, "must be a finite number");
        return *number;
    }

    void readColumns(const toml::table& table) {
        for (const auto& [key, node] : table) {
            MappedColumn column;
            column.column = std::string(key.str());
            column.line = static_cast<long>(node.source().begin.line);
            const std::string path = "columns.\"" + column.column + "\"";
            if (const auto* details = node.as_table()) {
                readDetails(*details, path, column);
            } else {
                column.channel = readText(node, path);
            }
            if (column.channel != "time" && !parseChannelName(column.channel))
                fail(node, path, "'" + column.channel + "' is not a channel", kChannelNames);
            const auto twin = std::find_if(map_.columns.begin(), map_.columns.end(),
                                           [&](const MappedColumn& other) { return other.channel == column.channel; });
            if (twin != map_.columns.end())
                fail(node, path, "'" + column.channel + "' is given by column '" + twin->column + "' already");
            map_.columns.push_back(std::move(column));
        }
    }

    void readDetails(const toml::table& details, const std::string& path, MappedColumn& column) const {
        for (const auto& [key, node] : details) {
            const std::string name(key.str());
            std::string full = path;
            full.append(".").append(name);
            if (name == "channel") {
                column.channel = readText(node, full);
            } else if (name == "unit") {
                column.unit = readText(node, full);
            } else if (name == "scale") {
                column.scale = readNumber(node, full);
                if (column.scale == 0) fail(node, full, "must not be 0");
            } else if (name == "offset") {
                column.offset = readNumber(node, full);
            } else {
                fail(node, full, "unknown key", "channel, unit, scale, offset");
            }
        }
        if (column.channel.empty()) fail(details, path, "channel is missing", kChannelNames);
    }

    void readShape(const toml::table& table) {
        for (const auto& [key, node] : table) {
            const std::string name(key.str());
            const std::string path = "table." + name;
            if (name == "time") {
                if (readText(node, path) != "none") fail(node, path, "not understood", "\"none\"");
                map_.has_time = false;
            } else if (name == "sample_interval") {
                map_.sample_interval = readNumber(node, path);
                if (!(map_.sample_interval > 0)) fail(node, path, "must be above 0 s");
            } else if (name == "separator") {
                map_.separator = readCharacter(node, path, ",;\t", "\",\", \";\", \"\\t\"");
            } else if (name == "decimal") {
                map_.decimal = readCharacter(node, path, ".,", "\".\", \",\"");
            } else if (name == "skip_rows") {
                const auto rows = node.value_exact<std::int64_t>();
                if (!rows || *rows < 0 || *rows > 1000000) fail(node, path, "must be a whole number from 0 to 1000000");
                map_.skip_rows = static_cast<int>(*rows);
            } else if (name == "rest") {
                map_.rest = readRest(node, path);
            } else {
                fail(node, path, "unknown key", "time, sample_interval, separator, decimal, skip_rows, rest");
            }
        }
        if (table.contains("sample_interval") && map_.has_time)
            fail(*table.get("sample_interval"), "table.sample_interval", "only with time = \"none\"");
    }

    RestPosition readRest(const toml::node& node, const std::string& path) const {
        if (node.is_string()) {
            if (readText(node, path) != "none") fail(node, path, "not understood", "a duration in s, or \"none\"");
            return {RestPosition::Kind::none, 0};
        }
        const double duration = readNumber(node, path);
        if (duration < 0) fail(node, path, "must not be negative");
        return {RestPosition::Kind::mean, duration};
    }

    char readCharacter(const toml::node& node, const std::string& path, std::string_view choices,
                       const char* accepted) const {
        const auto text = readText(node, path);
        if (text.size() != 1 || choices.find(text[0]) == std::string_view::npos)
            fail(node, path, "'" + text + "' is not understood", accepted);
        return text[0];
    }

    ColumnMap map_;
};

}  // namespace

ColumnMap parseColumnMap(std::string_view text, const std::string& file) {
    return MapReader(file).read(parseToml(text, file));
}

ColumnMap readColumnMap(const std::string& file) {
    return parseColumnMap(TextFile(file).view(), file);
}

namespace {

constexpr std::size_t kLongestList = 300;  // characters in a message

bool matches(const MappedColumn& mapped, const OfferedColumn& column) {
    if (mapped.column == column.text || mapped.column == parseColumnHeader(column.text, true).name) return true;
    return std::find(column.aliases.begin(), column.aliases.end(), mapped.column) != column.aliases.end();
}

class Selector {
public:
    Selector(const std::vector<OfferedColumn>& offered, const std::string& file, long header_row, const ColumnMap* map,
             MissingUnit missing_unit)
        : offered_(offered), file_(file), header_row_(header_row), map_(map), missing_unit_(missing_unit) {}

    ColumnSelection select() {
        for (std::size_t i = 0; i < offered_.size(); ++i) selectColumn(i);
        checkMapUsed();
        const bool numbered = map_ != nullptr && !map_->has_time;
        if (!numbered && names_.count(kTime) == 0) {
            throw InputError({file_, header_row_, kTime}, "there is no time column; there are " + listTexts(),
                             "`time [s]`, or a column map that names it or says time = \"none\"");
        }
        const bool has_channel = std::any_of(selection_.columns.begin(), selection_.columns.end(),
                                             [](const SelectedColumn& column) { return column.name != kTime; });
        if (!has_channel) {
            throw InputError({file_, header_row_, {}}, "no column is a channel; there are " + listTexts(),
                             "mobile.<connection>.x [mm], load.fz [N] and the like, or a column map");
        }
        return std::move(selection_);
    }

private:
    void selectColumn(std::size_t index) {
        const OfferedColumn& column = offered_[index];
        const MappedColumn* mapped = findMapped(column);
        const ColumnHeader header = parseColumnHeader(column.text, mapped != nullptr);
        const std::string& name = mapped != nullptr ? mapped->channel : header.name;
        const auto channel = parseChannelName(name);
        const bool ignored_time = name == kTime && map_ != nullptr && !map_->has_time;
        if ((!channel && name != kTime) || ignored_time) {
            selection_.unused.push_back(column.text);
            return;
        }
        const InputLocation location{file_, header_row_, name};
        if (!names_.insert(name).second) throw InputError(location, "there are two columns of this name");
        const Quantity quantity = channel ? findQuantity(*channel) : Quantity::time;

        SelectedColumn selected;
        selected.index = index;
        selected.name = name;
        if (mapped != nullptr && !mapped->unit.empty()) {
            selected.unit = mapped->unit;
        } else if (column.unit) {
            selected.unit = *column.unit;
        } else if (header.has_unit) {
            selected.unit = header.unit;
        } else if (missing_unit_ == MissingUnit::si ||
                   (missing_unit_ == MissingUnit::own_names && (mapped == nullptr || name == kTime))) {
            selected.unit = siUnit(quantity);
            selection_.without_unit.push_back(name);
        } else {
            throw InputError(location, "column '" + column.text + "' has no unit",
                             missing_unit_ == MissingUnit::error
                                 ? name + " [" + siUnit(quantity) + "]; units: " + listUnits(quantity)
                                 : "`unit = \"" + std::string(siUnit(quantity)) +
                                       "\"` in the column map; units: " + listUnits(quantity));
        }
        const double factor = findUnitFactor(selected.unit, quantity, location);
        selected.scale = mapped != nullptr ? mapped->scale * factor : factor;
        selected.offset = mapped != nullptr ? mapped->offset * factor : 0.0;
        selection_.columns.push_back(std::move(selected));
    }

    const MappedColumn* findMapped(const OfferedColumn& column) {
        if (map_ == nullptr) return nullptr;
        for (const auto& candidate : map_->columns) {
            if (!matches(candidate, column)) continue;
            used_.insert(&candidate);
            return &candidate;
        }
        return nullptr;
    }

    void checkMapUsed() const {
        if (map_ == nullptr) return;
        for (const auto& column : map_->columns) {
            if (used_.count(&column) != 0) continue;
            throw InputError({map_->file, column.line, column.column}, "there is no such column in " + file_,
                             listTexts());
        }
    }

    std::string listTexts() const {
        std::string present;
        for (const auto& column : offered_) {
            present += (present.empty() ? "" : ", ") + column.text;
            if (present.size() > kLongestList) return present.substr(0, kLongestList) + " …";
        }
        return present;
    }

    const std::vector<OfferedColumn>& offered_;
    const std::string& file_;
    long header_row_;
    const ColumnMap* map_;
    MissingUnit missing_unit_;
    ColumnSelection selection_;
    std::set<std::string> names_;
    std::set<const MappedColumn*> used_;
};

}  // namespace

ColumnHeader parseColumnHeader(const std::string& header, bool parentheses) {
    ColumnHeader parsed;
    parsed.name = std::string(trimCsvField(header));
    if (parsed.name.empty()) return parsed;
    const char last = parsed.name.back();
    const bool bracketed = last == ']' || (parentheses && last == ')');
    const auto open = bracketed ? parsed.name.rfind(last == ']' ? '[' : '(') : std::string::npos;
    if (open == std::string::npos) return parsed;
    parsed.unit =
        std::string(trimCsvField(std::string_view(parsed.name).substr(open + 1, parsed.name.size() - open - 2)));
    parsed.name = std::string(trimCsvField(std::string_view(parsed.name).substr(0, open)));
    parsed.has_unit = true;
    return parsed;
}

bool isKnownColumn(const std::string& text, const ColumnMap* map) {
    if (map != nullptr && std::any_of(map->columns.begin(), map->columns.end(), [&](const MappedColumn& mapped) {
            return matches(mapped, {text, {}, {}});
        }))
        return true;
    const std::string name = parseColumnHeader(text, false).name;
    return name == kTime || parseChannelName(name).has_value();
}

ColumnSelection selectColumns(const std::vector<OfferedColumn>& offered, const std::string& file, long header_row,
                              const ColumnMap* map, MissingUnit missing_unit) {
    return Selector(offered, file, header_row, map, missing_unit).select();
}

}  // namespace wems
