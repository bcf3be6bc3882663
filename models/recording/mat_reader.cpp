#include "models/recording/mat_reader.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/recording/hdf5_file.hpp"
#include "models/recording/separate_reader.hpp"

namespace wems {

namespace {

using Kind = MatValue::Kind;

bool isVector(const MatValue& value) {
    return value.kind == Kind::numbers && value.count() > 1 && (value.rows == 1 || value.columns == 1);
}

bool contains(const std::string& name, std::initializer_list<const char*> words) {
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return lower.find(word) != std::string::npos; });
}

/// The strings of a cell array of strings or of a character matrix; empty for anything else.
std::vector<std::string> listTexts(const MatValue& value) {
    if (value.kind == Kind::text) return value.texts;
    std::vector<std::string> texts;
    if (value.kind != Kind::cells) return texts;
    for (const auto& element : value.elements) {
        const bool empty = element.kind == Kind::other || element.count() == 0;
        if (element.kind == Kind::text && element.texts.size() == 1) {
            texts.push_back(element.texts.front());
        } else if (empty && element.texts.empty()) {
            texts.emplace_back();
        } else {
            return {};
        }
    }
    return texts;
}

/// `mobile_1_x` as `mobile.1.x`, if that is a channel.
std::string withPoints(const std::string& name) {
    const auto first = name.find('_'), last = name.rfind('_');
    if (first == std::string::npos || name.find('.') != std::string::npos) return name;
    std::string pointed = name;
    pointed[first] = pointed[last] = '.';
    return parseChannelName(pointed) ? pointed : name;
}

const MatValue* findFirst(const MatValue& element, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (const MatValue* found = element.find(name)) return found;
    }
    return nullptr;
}

std::string textOf(const MatValue* value) {
    return value != nullptr && value->kind == Kind::text && value->texts.size() == 1 ? value->texts.front()
                                                                                     : std::string();
}

class TableMaker {
public:
    explicit TableMaker(MatTable& target) : table_(target.table), series_(target.series) {}

    void addContainer(const MatValue& container, const std::string& path) {
        const MatValue* data = findFirst(container, {"data", "Data", "values", "Values", "value", "y", "Y"});
        const std::string label =
            textOf(findFirst(container, {"name", "Name", "label", "Label", "title", "Title", "channel", "Channel"}));
        const std::string unit = textOf(findFirst(container, {"unit", "Unit", "units", "Units"}));
        for (const auto& [name, value] : container.fields) {
            const std::string full = path.empty() ? name : path + "." + name;
            if (&value == data && isVector(value)) {
                OfferedColumn column{label.empty() ? (path.empty() ? full : path) : label, {}, {full}};
                if (!unit.empty()) column.unit = unit;
                addColumn(std::move(column), {&value, value.columns == 1, 0});
            } else {
                addValue(value, full, container);
            }
        }
    }

private:
    void addValue(const MatValue& value, const std::string& path, const MatValue& container) {
        switch (value.kind) {
            case Kind::numbers:
                addNumbers(value, path, container);
                break;
            case Kind::text:
                if (value.texts.size() == 1) table_.metadata[path] = value.texts.front();
                break;
            case Kind::structs:
                for (std::size_t i = 0; i < value.elements.size(); ++i)
                    addContainer(value.elements[i],
                                 value.elements.size() == 1 ? path : path + "(" + std::to_string(i + 1) + ")");
                break;
            case Kind::cells:
                for (std::size_t i = 0; i < value.elements.size(); ++i) {
                    if (value.elements[i].kind == Kind::text) continue;
                    addValue(value.elements[i], path + "{" + std::to_string(i + 1) + "}", container);
                }
                break;
            case Kind::other:
                unread_.push_back(path);
                break;
        }
    }

    void addNumbers(const MatValue& value, const std::string& path, const MatValue& container) {
        if (value.numbers.size() == 1) table_.metadata[path] = formatNumber(value.numbers.front(), 12);
        if (value.count() < 2) return;
        if (isVector(value)) {
            addColumn({path, {}, {}}, {&value, value.columns == 1, 0});
            return;
        }
        const bool down = value.rows >= value.columns;  // samples run down the columns
        const std::size_t channels = down ? value.columns : value.rows;
        const auto names =
            findList(container, value, channels, {"name", "label", "channel", "header", "legend", "columns"});
        const auto units = findList(container, value, channels, {"unit"});
        for (std::size_t j = 0; j < channels; ++j) {
            std::string numbered = path;
            numbered.append(".").append(std::to_string(j + 1));
            OfferedColumn column{names.empty() || names[j].empty() ? numbered : names[j], {}, {numbered}};
            if (!units.empty() && !units[j].empty()) column.unit = units[j];
            addColumn(std::move(column), {&value, down, j});
        }
    }

    /// A list of `count` texts beside `value` whose name has one of `words` in it.
    static std::vector<std::string> findList(const MatValue& container, const MatValue& value, std::size_t count,
                                             std::initializer_list<const char*> words) {
        for (const auto& [name, sibling] : container.fields) {
            if (&sibling == &value || !contains(name, words)) continue;
            auto texts = listTexts(sibling);
            if (texts.size() == count) return texts;
        }
        return {};
    }

    void addColumn(OfferedColumn column, const MatSeries& series) {
        const std::string pointed = withPoints(column.text);
        if (pointed != column.text) {
            column.aliases.push_back(column.text);
            column.text = pointed;
        }
        table_.columns.push_back(std::move(column));
        series_.push_back(series);
    }

public:
    void finish() {
        for (const auto& path : unread_)
            table_.warnings.push_back(path + " is complex, sparse, an object or empty, and is not read");
    }

private:
    RecordingTable& table_;
    std::vector<MatSeries>& series_;
    std::vector<std::string> unread_;
};

}  // namespace

std::vector<double> MatSeries::read(std::size_t first, std::size_t count) const {
    if (array->stored)
        return down ? array->stored->read(first, count, channel, 1) : array->stored->read(channel, 1, first, count);
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i)
        values[i] = array->numbers[down ? channel * array->rows + first + i : (first + i) * array->rows + channel];
    return values;
}

MatTable tabulateMat(MatFile content, const std::string& file) {
    MatTable result;
    result.content = std::make_shared<const MatFile>(std::move(content));
    RecordingTable& table = result.table;
    table.file = file;
    table.format = result.content->version;
    table.missing_unit = MissingUnit::own_names;
    TableMaker maker(result);
    const auto& variables = result.content->root.fields;
    const MatValue* only = variables.size() == 1 ? &variables.front().second : nullptr;
    if (only != nullptr && only->kind == Kind::structs && only->elements.size() == 1) {
        maker.addContainer(only->elements.front(), "");
    } else {
        maker.addContainer(result.content->root, "");
    }
    maker.finish();
    if (result.content->has_objects) table.warnings.emplace_back("objects and what functions hold are not read");
    if (table.columns.empty())
        throw InputError({file, 0, {}}, "holds no numeric vector or matrix that can be read",
                         "numeric arrays and structures; MATLAB's table and timeseries objects must be saved as "
                         "structures or arrays");
    return result;
}

RecordingTable takeValues(MatTable read) {
    for (const MatSeries& series : read.series) read.table.values.push_back(series.read(0, series.sampleCount()));
    return std::move(read.table);
}

RecordingTable readMat(const std::string& file, bool hdf5) {
    return takeValues(tabulateMat(hdf5 ? readSeparately(file, "HDF5", [&file] { return readHdf5File(file); })
                                       : readSeparately(file, "matio", [&file] { return readMatFile(file); }),
                                  file));
}

namespace {

constexpr std::size_t kSamplesAtOnce = 8192;
constexpr std::size_t kSmall = 4096;  // numbers of an array that is read at once

/// The same samples of many channels. Where a row of the file has a sample of every channel, it is read once for all.
class Stretch {
public:
    Stretch(std::size_t first, std::size_t count) : first_(first), count_(count) {}

    std::vector<double> read(const MatSeries& series) {
        const MatValue& array = *series.array;
        if (series.down || !array.stored || array.rows == 1) return series.read(first_, count_);
        auto found = rows_.find(&array);
        if (found == rows_.end())
            found = rows_.emplace(&array, array.stored->read(0, array.rows, first_, count_)).first;
        std::vector<double> values(count_);
        for (std::size_t i = 0; i < count_; ++i) values[i] = found->second[i * array.rows + series.channel];
        return values;
    }

private:
    std::size_t first_, count_;
    std::map<const MatValue*, std::vector<double>> rows_;
};

}  // namespace

Hdf5Rows::Hdf5Rows(const std::string& file, const ColumnMap* map)
    : content_(tabulateMat(readSeparately(file, "HDF5", [&file] { return readHdf5File(file, kSmall); }), file)),
      plan_(planTable(content_.table, map)) {
    const auto count = [this](const SelectedColumn& column) { return content_.series[column.index].sampleCount(); };
    sample_count_ = checkLengths(plan_, count);
}

bool Hdf5Rows::append(Recording& rows) {
    const std::size_t count = std::min(kSamplesAtOnce, sample_count_ - samples_read_);
    if (count == 0) return false;
    Stretch part(samples_read_, count);
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, part.read(content_.series[plan_.columns[k].index]), rows);
    samples_read_ += count;
    return true;
}

}  // namespace wems
