#include "models/recording/column_selection.hpp"

#include <algorithm>
#include <set>

#include "models/error.hpp"
#include "models/recording/csv_layout.hpp"
#include "models/recording/recording.hpp"

namespace wems {
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
