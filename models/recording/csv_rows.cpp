#include "models/recording/csv_rows.hpp"

#include <algorithm>
#include <filesystem>

#include "models/error.hpp"

namespace wems {
namespace {

constexpr std::size_t kReadAtOnce = 4U << 20U;   // bytes
constexpr std::size_t kLongestRow = 64U << 20U;  // bytes

/// Rows of `text`, the last one with or without its line end.
std::size_t countCsvRows(std::string_view text) {
    const std::size_t ends = std::count(text.begin(), text.end(), '\n');
    return ends + (text.empty() || text.back() == '\n' ? 0 : 1);
}

}  // namespace

CsvRows::CsvRows(const std::string& file, const ColumnMap* map) : file_(file), input_(file, std::ios::binary) {
    if (!input_) throw InputError({file, 0, {}}, "cannot be opened");
    const std::string_view rows = readText();
    plan_ = planCsv(rows, file, map);
    const std::string_view body = plan_.layout.body;
    const auto rest = static_cast<double>(std::filesystem::file_size(file) - (rows.size() - body.size()));
    expected_samples_ = static_cast<double>(countCsvRows(body)) * rest / static_cast<double>(body.size());
}

bool CsvRows::append(Recording& rows) {
    if (!is_first_) {
        if (at_end_) return false;
        plan_.layout.body = readText();
    }
    is_first_ = false;
    parse(rows);
    return true;
}

/// Whole rows, at least one; none at the end of the file.
std::string_view CsvRows::readText() {
    text_.erase(0, parsed_text_);
    for (;;) {
        const std::size_t before = text_.size();
        text_.resize(before + kReadAtOnce);
        input_.read(&text_[before], static_cast<std::streamsize>(kReadAtOnce));
        text_.resize(before + static_cast<std::size_t>(input_.gcount()));
        if (input_.bad()) throw InputError({file_, 0, {}}, "cannot be read to its end");
        at_end_ = input_.eof();
        parsed_text_ = at_end_ ? text_.size() : text_.rfind('\n') + 1;  // 0 if there is none
        if (at_end_ || parsed_text_ > 0) return std::string_view(text_).substr(0, parsed_text_);
        if (text_.size() > kLongestRow)
            throw InputError({file_, plan_.layout.first_row, {}}, "a row is longer than 64 MB");
    }
}

/// Parses the rows of the layout's body, which readText() has read.
void CsvRows::parse(Recording& rows) {
    CsvLayout& layout = plan_.layout;
    if (isBlankCsv(layout.body, layout.separator)) {
        past_rows_ = past_rows_ || !layout.body.empty();
        return;
    }
    if (past_rows_) throw InputError({file_, layout.first_row, {}}, "blank row inside the data");
    layout.has_quotes = layout.body.find('"') != std::string_view::npos;
    const std::size_t count = appendRows(plan_, rows);
    layout.first_row += static_cast<long>(count);
    past_rows_ = count < countCsvRows(layout.body);
}

}  // namespace wems
