#include "models/recording/column_map.hpp"

#include <algorithm>
#include <cmath>

#include "models/error.hpp"
#include "models/recording/recording.hpp"
#include "models/recording/text_file.hpp"
#include "models/toml_table.hpp"

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

}  // namespace wems
