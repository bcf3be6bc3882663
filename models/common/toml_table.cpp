#include "models/common/toml_table.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"

namespace wems {
namespace {

std::string describe(const toml::node& node) {
    std::ostringstream text;
    text << node.type();
    return text.str();
}

/// A recording or a modes file in place of a TOML file is the likeliest mistake.
std::string describeExpectation(std::string_view text) {
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        if (line.find_first_not_of(" \t\r") == std::string_view::npos || line.front() == '#') continue;
        const bool table = line.find('=') == std::string_view::npos && line.find_first_of(",;\t") != line.npos;
        return table ? "a TOML file; this one looks like a table of data, such as a recording" : "a TOML file";
    }
    return "a TOML file";
}

constexpr int kMostParts =
    64;  // of a dotted key; each is a table within the one before, to the parser a call within a call

/// Refuses what would take more stack than there is. Strings count as one letter, comments as none.
void checkKeys(std::string_view text, const std::string& file) {
    long line = 1;
    int parts = 1;
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') {
            ++line;
            parts = 1;
            quote = 0;  // a string over several lines is read as words and dots, which are few
        } else if (quote != 0) {
            if (c == '\\' && quote == '"') ++i;
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '#') {
            i = std::min(text.find('\n', i), text.size()) - 1;
        } else if (c == '.') {
            ++parts;
        } else if (std::string_view("=,[]{}").find(c) != std::string_view::npos) {
            parts = 1;
        }
        if (parts > kMostParts)
            throw InputError({file, line, {}}, "a key has more than " + std::to_string(kMostParts) + " parts",
                             "keys such as body.mass");
    }
}

}  // namespace

long TomlPlaces::find(const std::string& key) const {
    for (std::string part = key; !part.empty();) {
        if (const auto found = line.find(part); found != line.end()) return found->second;
        const auto cut = part.find_last_of(".[");
        if (cut == std::string::npos) break;
        part.resize(cut);
    }
    return 0;
}

TomlTable::TomlTable(const toml::table& table, std::string prefix, TomlPlaces& places)
    : table_(table), prefix_(std::move(prefix)), places_(places) {
    for (const auto& [key, node] : table) {
        // The key's own place: a table that dotted keys made has none.
        places_.line[fullKey(std::string(key.str()))] = static_cast<long>(key.source().begin.line);
    }
}

void TomlTable::fail(const std::string& key, const std::string& problem, const std::string& accepted) const {
    const std::string full_key = key.empty() ? prefix_ : fullKey(key);
    throw InputError({places_.file, places_.find(full_key), full_key}, problem, accepted);
}

const toml::node* TomlTable::find(const std::string& key) {
    asked_.push_back(key);
    return table_.get(key);
}

double TomlTable::toNumber(const toml::node& node, const std::string& key) const {
    double number = 0;
    if (const auto* floating = node.as_floating_point()) {
        number = floating->get();
    } else if (const auto* integer = node.as_integer()) {
        number = static_cast<double>(integer->get());
    } else {
        fail(key, "is of the type " + describe(node), "a number");
    }
    if (!std::isfinite(number)) fail(key, "is " + formatNumber(number), "a finite number");
    return number;
}

const toml::array& TomlTable::toArray(const toml::node& node, const std::string& key,
                                      const std::string& accepted) const {
    if (const auto* array = node.as_array()) return *array;
    fail(key, "is of the type " + describe(node), accepted);
}

std::optional<double> TomlTable::findNumber(const std::string& key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    return toNumber(*node, key);
}

double TomlTable::requireNumber(const std::string& key, const std::string& unit) {
    if (const auto number = findNumber(key)) return *number;
    fail(key, "is missing", "a number" + (unit.empty() ? "" : ", " + unit));
}

std::optional<std::string> TomlTable::findString(const std::string& key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* text = node->as_string()) return text->get();
    fail(key, "is of the type " + describe(*node), "text in quotes");
}

std::string TomlTable::requireString(const std::string& key, const std::string& accepted) {
    if (const auto text = findString(key)) return *text;
    fail(key, "is missing", accepted);
}

std::vector<double> TomlTable::requireNumbers(const std::string& key, const std::vector<std::size_t>& lengths,
                                              const std::string& accepted) {
    const toml::node* node = find(key);
    if (node == nullptr) fail(key, "is missing", accepted);
    const toml::array& array = toArray(*node, key, accepted);
    if (std::find(lengths.begin(), lengths.end(), array.size()) == lengths.end()) {
        fail(key, "has " + std::to_string(array.size()) + " values", accepted);
    }
    std::vector<double> numbers;
    for (const toml::node& element : array) {
        numbers.push_back(toNumber(element, key + "[" + std::to_string(numbers.size()) + "]"));
    }
    return numbers;
}

std::optional<Eigen::Vector3d> TomlTable::findVector(const std::string& key) {
    if (!has(key)) {
        asked_.push_back(key);
        return std::nullopt;
    }
    return requireVector(key, {});
}

std::optional<std::vector<std::string>> TomlTable::findStrings(const std::string& key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    const char* accepted = "a list of texts in quotes";
    std::vector<std::string> texts;
    for (const toml::node& element : toArray(*node, key, accepted)) {
        const auto* text = element.as_string();
        if (text == nullptr)
            fail(key + "[" + std::to_string(texts.size()) + "]", "is of the type " + describe(element), accepted);
        texts.push_back(text->get());
    }
    return texts;
}

Eigen::Vector3d TomlTable::requireVector(const std::string& key, const std::string& unit) {
    const auto numbers = requireNumbers(key, {3}, "a list of three numbers" + (unit.empty() ? "" : ", " + unit));
    return {numbers[0], numbers[1], numbers[2]};
}

long TomlTable::requireInteger(const std::string& key, const std::string& accepted) {
    const toml::node* node = find(key);
    if (node == nullptr) fail(key, "is missing", accepted);
    if (const auto* integer = node->as_integer()) return static_cast<long>(integer->get());
    fail(key, "is of the type " + describe(*node), accepted);
}

std::optional<std::vector<std::vector<double>>> TomlTable::findRows(const std::string& key, std::size_t columns,
                                                                    std::size_t most) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    most = std::max(most, columns);
    const std::string count = std::to_string(columns) + (most > columns ? " to " + std::to_string(most) : "");
    const std::string numbers = count + " numbers", accepted = "a list of rows of " + numbers;
    std::vector<std::vector<double>> rows;
    for (const toml::node& element : toArray(*node, key, accepted)) {
        const std::string element_key = key + "[" + std::to_string(rows.size()) + "]";
        const toml::array& cells = toArray(element, element_key, accepted);
        if (cells.size() < columns || cells.size() > most)
            fail(element_key, "has " + std::to_string(cells.size()) + " values", numbers);
        std::vector<double> row;
        for (const toml::node& cell : cells) row.push_back(toNumber(cell, element_key));
        rows.push_back(std::move(row));
    }
    return rows;
}

bool TomlTable::readTable(const std::string& key, const std::function<void(TomlTable&)>& read) {
    const toml::node* node = find(key);
    if (node == nullptr) return false;
    const toml::table* table = node->as_table();
    if (table == nullptr) fail(key, "is of the type " + describe(*node), "a table");
    TomlTable reader(*table, fullKey(key), places_);
    read(reader);
    reader.rejectUnknownKeys();
    return true;
}

std::size_t TomlTable::readTables(const std::string& key, const std::function<void(TomlTable&)>& read) {
    const toml::node* node = find(key);
    if (node == nullptr) return 0;
    std::size_t count = 0;
    for (const toml::node& element : toArray(*node, key, "a list of tables")) {
        const std::string element_key = key + "[" + std::to_string(count++) + "]";
        places_.line[fullKey(element_key)] = static_cast<long>(element.source().begin.line);
        const toml::table* table = element.as_table();
        if (table == nullptr) fail(element_key, "is of the type " + describe(element), "a table");
        TomlTable reader(*table, fullKey(element_key), places_);
        read(reader);
        reader.rejectUnknownKeys();
    }
    return count;
}

void TomlTable::rejectUnknownKeys() const {
    for (const auto& [key, node] : table_) {
        const std::string name(key.str());
        if (std::find(asked_.begin(), asked_.end(), name) != asked_.end()) continue;
        std::string known;
        for (const std::string& asked : asked_) known += (known.empty() ? "" : ", ") + asked;
        fail(name, "is not known here", known);
    }
}

toml::table parseToml(std::string_view text, const std::string& file) {
    checkKeys(text, file);
    try {
        return toml::parse(text, file);
    } catch (const toml::parse_error& error) {
        throw InputError({file, static_cast<long>(error.source().begin.line), {}},
                         "not valid TOML: " + std::string(error.description()), describeExpectation(text));
    }
}

void readTomlFile(const std::string& file, const std::function<void(TomlTable&)>& read) {
    const TextFile text(file);
    const toml::table parsed = parseToml(text.view(), file);
    TomlPlaces places{file, {}};
    TomlTable root(parsed, "", places);
    read(root);
    root.rejectUnknownKeys();
}

}  // namespace wems
