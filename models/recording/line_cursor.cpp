#include "models/recording/line_cursor.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <limits>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems {
namespace {

constexpr std::string_view kOuter = " \t\r\f";  // of a field

/// One row of numbers, taken apart in place.
class RowParser {
public:
    RowParser(const std::string& file, std::size_t columns) : file_(file), row_(columns) {}

    const std::vector<double>& parse(std::string_view line, long number) {
        const bool tabs = line.find('\t') != std::string_view::npos;
        const char* p = line.data();
        const char* end = p + line.size();
        std::size_t count = 0;
        while (p != end) {
            while (p != end && *p == ' ') ++p;
            if (p == end) break;
            double value = std::numeric_limits<double>::quiet_NaN();
            if (!isSeparator(*p)) p = parseNumber(p, end, number, count, value);
            if (count == row_.size() && value == value)
                throw InputError({file_, number, {}},
                                 "the row has more than the " + std::to_string(row_.size()) + " numbers of the header");
            if (count < row_.size()) row_[count] = value;
            ++count;
            while (p != end && *p == ' ') ++p;
            if (p != end && isSeparator(*p)) {
                ++p;
            } else if (p != end && tabs) {
                throw InputError({file_, number, {}}, "two numbers without a tab between them");
            }
        }
        if (count < row_.size() && !tabs)
            throw InputError({file_, number, {}}, "the row has " + std::to_string(count) + " numbers, the header " +
                                                      std::to_string(row_.size()));
        for (; count < row_.size(); ++count) row_[count] = std::numeric_limits<double>::quiet_NaN();
        return row_;
    }

private:
    static bool isSeparator(char c) { return c == '\t' || c == ','; }

    const char* parseNumber(const char* p, const char* end, long number, std::size_t column, double& value) const {
        const char* first = *p == '+' ? p + 1 : p;
        const auto result = fast_float::from_chars(first, end, value);
        const bool ends = result.ptr == end || *result.ptr == ' ' || isSeparator(*result.ptr);
        if (result.ec == std::errc() && ends) return result.ptr;
        const std::string_view text(p, end - p);
        throw InputError({file_, number, {}},
                         "'" + std::string(text.substr(0, std::min<std::size_t>(text.find_first_of(" \t,"), 40))) +
                             "', number " + std::to_string(column + 1) + " of the row, is not a number");
    }

    const std::string& file_;
    std::vector<double> row_;
};

}  // namespace

std::string_view LineCursor::take() {
    const auto end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++line_;
    return line;
}

std::vector<std::string_view> splitFields(std::string_view line) {
    std::vector<std::string_view> fields;
    if (line.find('\t') != std::string_view::npos) {
        for (std::size_t start = 0;;) {
            const auto tab = line.find('\t', start);
            fields.push_back(trim(line.substr(start, tab == std::string_view::npos ? tab : tab - start), kOuter));
            if (tab == std::string_view::npos) return fields;
            start = tab + 1;
        }
    }
    for (std::size_t start = 0;;) {
        start = line.find_first_not_of(' ', start);
        if (start == std::string_view::npos) return fields;
        const auto end = line.find(' ', start);
        fields.push_back(trim(line.substr(start, end == std::string_view::npos ? end : end - start), kOuter));
        if (end == std::string_view::npos) return fields;
        start = end;
    }
}

double estimateRows(std::string_view text) {
    const std::string_view head = text.substr(0, 1U << 20U);
    const auto ends = static_cast<double>(std::count(head.begin(), head.end(), '\n'));
    const bool whole = head.size() == text.size();
    if (whole) return ends + (text.empty() || text.back() == '\n' ? 0 : 1);
    return ends * static_cast<double>(text.size()) / static_cast<double>(head.size());
}

std::vector<std::vector<double>> readNumberRows(LineCursor& lines, std::size_t columns, const std::string& file,
                                                std::size_t most) {
    std::vector<std::vector<double>> values(columns);
    RowParser parser(file, columns);
    for (std::size_t rows = 0; rows < most && !lines.atEnd(); ++rows) {
        const auto line = lines.take();
        if (trim(line, kOuter).empty()) {
            if (trim(lines.rest(), kOuter).find_first_not_of('\n') == std::string_view::npos) {
                lines.skip(lines.rest().size());
                break;
            }
            throw InputError({file, lines.line(), {}}, "blank row inside the data");
        }
        const auto& row = parser.parse(line, lines.line());
        for (std::size_t j = 0; j < columns; ++j) values[j].push_back(row[j]);
    }
    return values;
}

}  // namespace wems
