#include "models/recording/json_reader.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "models/common/error.hpp"
#include "models/recording/mat_reader.hpp"

namespace wems {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 16;  // levels; a table needs three

bool isNumberOrNull(const Json& value) {
    return value.is_number() || value.is_null();
}

double toNumber(const Json& value) {
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

class Converter {
public:
    explicit Converter(const std::string& file) : file_(file) {}

    MatValue convert(const Json& value, const std::string& name, int depth) const {
        MatValue result;
        if (depth > kDeepest) return result;
        if (isNumberOrNull(value)) {
            result.kind = MatValue::Kind::numbers;
            result.rows = result.columns = 1;
            result.numbers = {toNumber(value)};
        } else if (value.is_string()) {
            result.kind = MatValue::Kind::text;
            result.texts = {value.get<std::string>()};
        } else if (value.is_object()) {
            result.kind = MatValue::Kind::structs;
            MatValue element;
            for (const auto& [key, member] : value.items())
                element.fields.emplace_back(key, convert(member, key, depth + 1));
            result.elements.push_back(std::move(element));
        } else if (value.is_array() && !value.empty()) {
            convertArray(value, name, depth, result);
        }
        return result;
    }

private:
    void convertArray(const Json& array, const std::string& name, int depth, MatValue& result) const {
        if (std::all_of(array.begin(), array.end(), isNumberOrNull)) {
            result.kind = MatValue::Kind::numbers;
            result.rows = array.size();
            result.columns = 1;
            for (const Json& value : array) result.numbers.push_back(toNumber(value));
        } else if (array.front().is_array()) {
            convertRows(array, name, result);
        } else {
            result.kind = MatValue::Kind::cells;
            for (const Json& value : array) result.elements.push_back(convert(value, name, depth + 1));
        }
    }

    void convertRows(const Json& rows, const std::string& name, MatValue& result) const {
        result.kind = MatValue::Kind::numbers;
        result.rows = rows.size();
        result.columns = rows.front().size();
        result.numbers.resize(result.rows * result.columns);
        for (std::size_t i = 0; i < result.rows; ++i) {
            const Json& row = rows[i];
            if (!row.is_array() || row.size() != result.columns || !std::all_of(row.begin(), row.end(), isNumberOrNull))
                throw InputError({file_, 0, name},
                                 "row " + std::to_string(i + 1) + " is not a row of " + std::to_string(result.columns) +
                                     " numbers as the first is",
                                 "rows of one length, of numbers and null");
            for (std::size_t j = 0; j < result.columns; ++j) result.numbers[j * result.rows + i] = toNumber(row[j]);
        }
    }

    const std::string& file_;
};

long countLines(std::string_view text, std::size_t end) {
    return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(end, text.size())), '\n');
}

}  // namespace

bool isJson(std::string_view text) {
    std::size_t at = text.find_first_not_of(" \t\r\n");
    if (at == std::string_view::npos) return false;
    if (text[at] == '{') return true;
    if (text[at] != '[') return false;
    // Behind its brackets a TOML table has a name.
    at = text.find_first_not_of("[ \t\r\n", at);
    return at == std::string_view::npos || std::string_view("0123456789-]").find(text[at]) != std::string_view::npos;
}

RecordingTable readJson(std::string_view text, const std::string& file) {
    Json content;
    try {
        content = Json::parse(text);
    } catch (const Json::parse_error& error) {
        throw InputError({file, countLines(text, error.byte), ""}, "not JSON",
                         "an object of arrays, or rows of numbers");
    }
    MatFile table;
    table.version = "JSON";
    if (content.is_array()) content = Json{{"data", std::move(content)}};
    table.root = Converter(file).convert(content, "", 0);
    // As the reader of MATLAB's files has it: the fields of the root are the variables.
    if (!table.root.elements.empty()) table.root = MatValue(table.root.elements.front());
    table.root.kind = MatValue::Kind::structs;
    return takeValues(tabulateMat(std::move(table), file));
}

}  // namespace wems
