#include "models/recording/csv_layout.hpp"

#include <algorithm>
#include <array>

#include "models/error.hpp"

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
    if (startsWith("\xFF\xFE") || startsWith("\xFE\xFF")) {
        problem = "the text is UTF-16; save it as UTF-8";
    } else if (startsWith("\x1F\x8B") ||
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

void readMetadata(std::string_view row, std::map<std::string, std::string>& metadata) {
    row.remove_prefix(1);
    const auto colon = row.find(':');
    if (colon == std::string_view::npos) return;
    const auto key = trimCsvField(row.substr(0, colon));
    if (!key.empty()) metadata[std::string(key)] = std::string(trimCsvField(row.substr(colon + 1)));
}

char findSeparator(std::string_view header) {
    std::array<long, 3> counts{};
    constexpr std::string_view kCandidates = ";\t,";
    bool quoted = false;
    for (const char c : header) {
        if (c == '"') quoted = !quoted;
        const auto index = kCandidates.find(c);
        if (!quoted && index != std::string_view::npos) ++counts[index];
    }
    return kCandidates[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
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

CsvHeader parseCsvHeader(const std::string& header, bool parentheses) {
    CsvHeader parsed;
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

CsvLayout readCsvLayout(std::string_view text, const std::string& file, const ColumnMap* map) {
    rejectBinary(text, file);
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());

    CsvLayout layout;
    std::string_view header;
    for (int skip = map != nullptr ? map->skip_rows : 0; skip > 0 && !text.empty(); --skip, ++layout.header_row)
        takeRow(text);
    while (!text.empty()) {
        const auto row = takeRow(text);
        ++layout.header_row;
        if (trimCsvField(row).empty()) continue;
        if (row.front() != '#') {
            header = row;
            break;
        }
        readMetadata(row, layout.metadata);
    }
    if (header.empty()) throw InputError({file, 0, {}}, "there is no header row", "a row of `name [unit]`");

    layout.separator = map != nullptr && map->separator ? *map->separator : findSeparator(header);
    if (!splitCsvRow(header, layout.separator, layout.headers))
        throw InputError({file, layout.header_row, {}}, "a quote in the header row is not closed");
    while (!layout.headers.empty() && layout.headers.back().empty()) layout.headers.pop_back();
    layout.body = text;
    layout.has_quotes = text.find('"') != std::string_view::npos;
    layout.decimal =
        map != nullptr && map->decimal ? *map->decimal : findDecimal(text, layout.separator, layout.has_quotes);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        throw InputError({file, layout.header_row, {}}, "no data rows after the header");
    return layout;
}

}  // namespace wems
