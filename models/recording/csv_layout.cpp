#include "models/recording/csv_layout.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"
#include "models/common/units.hpp"
#include "models/recording/column_map.hpp"

namespace wems {
namespace {

/// Cuts the first row off `rest`, without its line end.
std::string_view takeRow(std::string_view& rest) {
    const auto end = rest.find('\n');
    std::string_view row = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!row.empty() && row.back() == '\r') row.remove_suffix(1);
    return row;
}

void rejectBinary(std::string_view text, const std::string& file) {
    const auto startsWith = [&](std::string_view magic) { return text.substr(0, magic.size()) == magic; };
    const char* problem = nullptr;
    if (startsWith("\x1F\x8B") ||
        startsWith("\xFD"
                   "7zXZ") ||
        startsWith("PK\x03\x04") || startsWith("BZh")) {
        problem = "the file is compressed or a spreadsheet's own format; unpack or export it as CSV";
    } else {
        const auto head = text.substr(0, 4096);
        const bool binary = std::any_of(head.begin(), head.end(), [](char c) {
            return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
        });
        if (binary) problem = "the file is binary, not text";
    }
    if (problem != nullptr) throw InputError({file, 0, {}}, problem, "CSV with one header row");
}

char guessSeparator(std::string_view header) {
    std::array<long, 3> counts{};
    constexpr std::string_view kCandidates = ";\t,";
    bool quoted = false;
    for (const char c : header) {
        if (c == '"') quoted = !quoted;
        const auto index = kCandidates.find(c);
        if (!quoted && index != std::string_view::npos) ++counts[index];
    }
    return kCandidates[std::max_element(counts.begin(), counts.end()) - counts.begin()];
}

/// The first point or comma inside a number decides; a comma that separates is none.
char findDecimal(std::string_view body, char separator, bool has_quotes) {
    if (separator != ',') {
        const auto first = body.find_first_of(".,");
        return first != std::string_view::npos && body[first] == ',' ? ',' : '.';
    }
    if (!has_quotes) return '.';
    bool quoted = false;
    for (const char c : body) {
        if (c == '"') quoted = !quoted;
        if (c == '.' || (c == ',' && quoted)) return c;
    }
    return '.';
}

bool isNumber(std::string_view text) {
    text = trimCsvField(text);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    for (const char decimal : {'.', ','}) {
        double value = 0;
        const auto result =
            fast_float::from_chars_advanced(text.data(), text.data() + text.size(), value,
                                            fast_float::parse_options(fast_float::chars_format::general, decimal));
        if (result.ec == std::errc() && result.ptr == text.data() + text.size()) return true;
    }
    return false;
}

/// `[mm]` or `(mm)` without its brackets.
std::string stripBrackets(const std::string& text) {
    const bool bracketed = text.size() >= 2 &&
                           ((text.front() == '[' && text.back() == ']') || (text.front() == '(' && text.back() == ')'));
    return bracketed ? std::string(trimCsvField(std::string_view(text).substr(1, text.size() - 2))) : text;
}

class LayoutReader {
public:
    LayoutReader(std::string_view text, const std::string& file, const ColumnMap* map)
        : rest_(text), file_(file), map_(map) {}

    CsvLayout read() {
        for (int skip = map_ != nullptr ? map_->skip_rows : 0; skip > 0 && !rest_.empty(); --skip, ++layout_.header_row)
            takeRow(rest_);
        findHeader();
        if (!splitCsvRow(header_, layout_.separator, layout_.headers))
            throw InputError({file_, layout_.header_row, {}}, "a quote in the header row is not closed");
        while (!layout_.headers.empty() && layout_.headers.back().empty()) layout_.headers.pop_back();
        layout_.first_row = layout_.header_row + 1;
        readRowsBelowHeader();
        layout_.body = rest_;
        layout_.has_quotes = rest_.find('"') != std::string_view::npos;
        layout_.decimal = map_ != nullptr && map_->decimal ? *map_->decimal
                                                           : findDecimal(rest_, layout_.separator, layout_.has_quotes);
        if (rest_.find_first_not_of(" \t\r\n") == std::string_view::npos)
            throw InputError({file_, layout_.header_row, {}}, "no data rows after the header");
        return std::move(layout_);
    }

private:
    char separatorOf(std::string_view row) const {
        return map_ != nullptr && map_->separator ? *map_->separator : guessSeparator(row);
    }

    /// Fields of `row` that are known; 0 for what cannot be a header.
    long countKnown(std::string_view row) const {
        std::vector<std::string> fields;
        if (!splitCsvRow(row, separatorOf(row), fields)) return 0;
        return std::count_if(fields.begin(), fields.end(),
                             [this](const std::string& field) { return isKnownColumn(field, map_); });
    }

    /// Leaves `rest_` after the header.
    void findHeader() {
        constexpr int kMostRows = 200;
        constexpr long kEnough = 2;  // known fields, after which no better row is looked for
        std::vector<std::string_view> before;
        std::string_view ahead = rest_;
        long row_number = layout_.header_row, best = -1;
        std::size_t text_rows = 0;  // rows of `before` that stand before the header
        for (int count = 0; count < kMostRows && !ahead.empty() && best < kEnough; ++count) {
            const auto row = takeRow(ahead);
            ++row_number;
            if (trimCsvField(row).empty()) continue;
            if (row.front() != '#') {
                const long known = countKnown(row);
                if (known > best) {
                    best = known;
                    header_ = row;
                    rest_ = ahead;
                    layout_.header_row = row_number;
                    text_rows = before.size();
                }
            }
            before.push_back(row);
        }
        if (best < 0) throw InputError({file_, 0, {}}, "there is no header row", "a row of `name [unit]`");
        layout_.separator = separatorOf(header_);
        before.resize(text_rows);
        for (const auto row : before) readMetadata(row);
    }

    void readMetadata(std::string_view row) {
        const bool marked = row.front() == '#';
        if (marked) row.remove_prefix(1);
        std::string_view key = row, value;
        if (const auto colon = row.find(':'); colon != std::string_view::npos) {
            key = row.substr(0, colon);
            value = row.substr(colon + 1);
        } else if (std::vector<std::string> fields;
                   !marked && splitCsvRow(row, layout_.separator, fields) && fields.size() >= 2) {
            const bool pair = std::all_of(fields.begin() + 2, fields.end(), [](const auto& f) { return f.empty(); });
            if (pair && !fields[0].empty()) layout_.metadata[fields[0]] = fields[1];
            return;
        } else {
            return;
        }
        const std::array<char, 5> blank = {' ', '\t', '\r', '"', layout_.separator};
        const auto bare = [&](std::string_view text) {
            return std::string(trim(text, std::string_view(blank.data(), blank.size())));
        };
        const std::string name = marked ? std::string(trimCsvField(key)) : bare(key);
        if (!name.empty())
            layout_.metadata[decodeLatin1(name)] = decodeLatin1(marked ? trimCsvField(value) : bare(value));
    }

    /// Rows without any number: units, or descriptions that nobody here needs.
    void readRowsBelowHeader() {
        constexpr int kMostRows = 4;
        std::vector<std::string> fields;
        for (int count = 0; count < kMostRows; ++count) {
            std::string_view ahead = rest_;
            const auto row = takeRow(ahead);
            if (isBlankCsv(row, layout_.separator) || !splitCsvRow(row, layout_.separator, fields)) return;
            if (std::any_of(fields.begin(), fields.end(), isNumber)) return;
            if (ahead.find_first_not_of(" \t\r\n") == std::string_view::npos) return;  // bad data, not units
            if (layout_.units.empty() && holdsUnits(fields)) {
                for (const auto& field : fields) layout_.units.push_back(stripBrackets(field));
                layout_.units.resize(layout_.headers.size());
            } else {
                layout_.warnings.push_back(
                    "row " + std::to_string(layout_.first_row) +
                    ", between header and numbers, is not read: " + cutUtf8(decodeLatin1(row), 60));
            }
            rest_ = ahead;
            ++layout_.first_row;
        }
    }

    /// True if the known columns have no unit in the header and units in this row.
    bool holdsUnits(const std::vector<std::string>& fields) const {
        bool found = false;
        for (std::size_t i = 0; i < std::min(fields.size(), layout_.headers.size()); ++i) {
            if (fields[i].empty() || !isKnownColumn(layout_.headers[i], map_)) continue;
            if (parseColumnHeader(layout_.headers[i], false).has_unit || !isUnit(stripBrackets(fields[i])))
                return false;
            found = true;
        }
        return found;
    }

    std::string_view rest_, header_;
    const std::string& file_;
    const ColumnMap* map_;
    CsvLayout layout_;
};

}  // namespace

std::string_view trimCsvField(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

bool splitCsvRow(std::string_view row, char separator, std::vector<std::string>& fields) {
    fields.assign(1, {});
    bool quoted = false, was_quoted = false;
    const auto finishField = [&] {
        if (!was_quoted) fields.back() = std::string(trimCsvField(fields.back()));
        if (!isUtf8(fields.back())) fields.back() = decodeLatin1(fields.back());
    };
    for (std::size_t i = 0; i < row.size(); ++i) {
        const char c = row[i];
        if (quoted) {
            if (c != '"') {
                fields.back() += c;
            } else if (i + 1 < row.size() && row[i + 1] == '"') {
                fields.back() += row[++i];
            } else {
                quoted = false;
            }
        } else if (c == '"' && trimCsvField(fields.back()).empty()) {
            fields.back().clear();
            quoted = was_quoted = true;
        } else if (c == separator) {
            finishField();
            fields.emplace_back();
            was_quoted = false;
        } else if (!(was_quoted && (c == ' ' || c == '\t' || c == '\r'))) {
            fields.back() += c;
        }
    }
    finishField();
    return !quoted;
}

CsvLayout readCsvLayout(std::string_view text, const std::string& file, const ColumnMap* map) {
    rejectBinary(text, file);
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
    return LayoutReader(text, file, map).read();
}

bool isBlankCsv(std::string_view text, char separator) {
    const std::array<char, 5> blank = {' ', '\t', '\r', '\n', separator};
    return text.find_first_not_of(std::string_view(blank.data(), blank.size())) == std::string_view::npos;
}

}  // namespace wems
