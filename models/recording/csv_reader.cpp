#include "models/recording/csv_reader.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording_table.hpp"

namespace wems {

namespace {

/// Rows are parsed into a small block, row by row, then moved to their columns: writing many columns at once would
/// touch as many pages for each row.
constexpr std::size_t kBlockNumbers = 2048;

std::string quoteForMessage(std::string_view text) {
    std::string shown;
    for (const char c : text.substr(0, 40)) shown += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    return "'" + shown + (text.size() > 40 ? "…'" : "'");
}

class BodyReader {
public:
    BodyReader(const CsvLayout& layout, const std::string& file, std::vector<CsvColumn>& columns)
        : layout_(layout), file_(file), columns_(columns), number_(fast_float::chars_format::general, layout.decimal) {
        field_count_ = static_cast<std::ptrdiff_t>(layout.headers.size());
        block_rows_ = std::clamp<std::size_t>(kBlockNumbers / columns.size(), 8, 128);
        block_.resize(block_rows_ * columns.size());
    }

    void read() {
        p_ = layout_.body.data();
        end_ = p_ + layout_.body.size();
        reserve();
        while (p_ != end_ && !atBlankRow()) {
            double* row = &block_[(row_ % block_rows_) * columns_.size()];
            if (layout_.has_quotes) {
                readQuotedRow(row);
            } else {
                readPlainRow(row);
            }
            if (++row_ % block_rows_ == 0) flush(block_rows_);
        }
        flush(row_ % block_rows_);
        checkRest();
        if (row_ == 0) throw InputError({file_, layout_.header_row, {}}, "no data rows after the header");
        for (auto& column : columns_) column.values.resize(row_);
    }

private:
    long fileRow() const { return layout_.first_row + static_cast<long>(row_); }

    /// As many rows as the first 64 kB suggest, and no more than the separators leave room for.
    void reserve() {
        const auto head = layout_.body.substr(0, 65536);
        const std::size_t newlines = std::count(head.begin(), head.end(), '\n');
        const double heads = static_cast<double>(layout_.body.size()) / static_cast<double>(head.size());
        const auto likely = static_cast<std::size_t>(1.02 * heads * static_cast<double>(newlines + 1));
        const std::size_t most = (layout_.body.size() + 1) / layout_.headers.size();
        grow(std::min(most, likely) + block_rows_);
    }

    void grow(std::size_t rows) {
        capacity_ = rows;
        for (auto& column : columns_) column.values.resize(rows);
    }

    void flush(std::size_t rows) {
        if (rows == 0) return;
        if (row_ > capacity_) grow(2 * row_);
        const std::size_t width = columns_.size(), first = row_ - rows;
        for (std::size_t j = 0; j < width; ++j) {
            double* target = &columns_[j].values[first];
            const double scale = columns_[j].scale, offset = columns_[j].offset;
            double probe = 0;  // becomes NaN with the first value that is not finite
            for (std::size_t i = 0; i < rows; ++i) {
                target[i] = scale * block_[i * width + j] + offset;
                probe += target[i] * 0;
            }
            if (std::isnan(probe)) columns_[j].has_non_finite = true;
        }
    }

    /// A row of separators and spaces only. Cheap for the usual first character.
    bool atBlankRow() const {
        if (*p_ == '-' || (*p_ >= '0' && *p_ <= '9')) return false;
        for (const char* q = p_; q != end_ && *q != '\n'; ++q) {
            if (*q != layout_.separator && *q != ' ' && *q != '\t' && *q != '\r') return false;
        }
        return true;
    }

    void checkRest() const {
        const std::string_view rest(p_, end_ - p_);
        const char blank[] = {' ', '\t', '\r', '\n', layout_.separator};
        if (rest.find_first_not_of(std::string_view(blank, sizeof blank)) != std::string_view::npos)
            throw InputError({file_, fileRow(), {}}, "blank row inside the data");
    }

    void readPlainRow(double* row) {
        std::ptrdiff_t column = 0;
        const char* p = p_;  // in a register, not in the object
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            const std::ptrdiff_t skip = columns_[k].index - column;
            if (skip == 1 && p != end_ && *p == layout_.separator) {
                ++p;
            } else {
                p = skipFields(p, skip, column);
            }
            p = readField(p, columns_[k], row[k]);
            column = columns_[k].index;
        }
        p_ = p;
        finishRow(column);
    }

    /// Returns the field's end. Most fields hold nothing but a number, whose end is theirs.
    const char* readField(const char* p, const CsvColumn& column, double& value) const {
        const auto number = fast_float::from_chars_advanced(p, end_, value, number_);
        if (number.ec == std::errc() && number.ptr != end_ && *number.ptr == layout_.separator && std::isfinite(value))
            return number.ptr;
        return readOddField(p, column, value);
    }

    /// Spaces or a sign in front, an empty field, the last one of a row.
    const char* readOddField(const char* p, const CsvColumn& column, double& value) const {
        const char* stop = p;
        while (stop != end_ && *stop != layout_.separator && *stop != '\n') ++stop;
        value = parseField({p, static_cast<std::size_t>(stop - p)}, column);
        return stop;
    }

    double parseField(std::string_view text, const CsvColumn& column) const {
        text = trimCsvField(text);
        if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
        double value = 0;
        const char* first = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
        const char* last = text.data() + text.size();
        const auto result = fast_float::from_chars_advanced(first, last, value, number_);
        const InputLocation location{file_, fileRow(), column.name};
        if (result.ec != std::errc() || result.ptr != last) {
            throw InputError(location, quoteForMessage(text) + " is not a number",
                             layout_.decimal == ',' ? "a number with decimal comma, or an empty field"
                                                    : "a number with decimal point, or an empty field");
        }
        if (std::isinf(value)) throw InputError(location, quoteForMessage(text) + " is not finite");
        return value;
    }

    /// Start of the field `count` further; `at` is the column of `p`.
    const char* skipFields(const char* p, std::ptrdiff_t count, std::ptrdiff_t at) const {
        constexpr std::ptrdiff_t kChunk = 64;
        std::ptrdiff_t left = count;
        while (left > kChunk && end_ - p > kChunk) {
            // Counted in bytes so that the compiler uses vector instructions; at most 64 each.
            unsigned char separators = 0, newlines = 0;
            for (std::ptrdiff_t i = 0; i < kChunk; ++i) {
                separators = static_cast<unsigned char>(separators + (p[i] == layout_.separator));
                newlines = static_cast<unsigned char>(newlines + (p[i] == '\n'));
            }
            if (newlines != 0) break;
            left -= separators;
            p += kChunk;
        }
        for (; left > 0; ++p) {
            if (p == end_ || *p == '\n') failRagged(at + count - left + 1);
            if (*p == layout_.separator) --left;
        }
        return p;
    }

    /// From the end of the last wanted field, or within its row, to the next row; checks the number of fields.
    void finishRow(std::ptrdiff_t column) {
        if (p_ != end_ && *p_ == '\n' && column + 1 == field_count_) {
            ++p_;
            return;
        }
        const auto* newline = static_cast<const char*>(std::memchr(p_, '\n', end_ - p_));
        const char* stop = newline != nullptr ? newline : end_;
        const std::ptrdiff_t fields = column + 1 + std::count(p_, stop, layout_.separator);
        if (fields < field_count_) failRagged(fields);
        if (fields > field_count_) {
            const char* extra = stop;
            for (auto left = fields - field_count_; left > 0;) left -= *--extra == layout_.separator;
            const bool blank = std::all_of(
                extra, stop, [&](char c) { return c == layout_.separator || c == ' ' || c == '\t' || c == '\r'; });
            if (!blank) failRagged(fields);
        }
        p_ = newline != nullptr ? newline + 1 : end_;
    }

    void readQuotedRow(double* row) {
        const auto* newline = static_cast<const char*>(std::memchr(p_, '\n', end_ - p_));
        const char* stop = newline != nullptr ? newline : end_;
        if (!splitCsvRow({p_, static_cast<std::size_t>(stop - p_)}, layout_.separator, fields_))
            throw InputError({file_, fileRow(), {}}, "a quote is not closed in this row");
        std::ptrdiff_t fields = fields_.size();
        while (fields > field_count_ && trimCsvField(fields_[fields - 1]).empty()) --fields;
        if (fields != field_count_) failRagged(fields);
        for (std::size_t k = 0; k < columns_.size(); ++k) row[k] = parseField(fields_[columns_[k].index], columns_[k]);
        p_ = newline != nullptr ? newline + 1 : end_;
    }

    [[noreturn]] void failRagged(std::ptrdiff_t fields) const {
        throw InputError({file_, fileRow(), {}}, "the row has " + std::to_string(fields) + " fields, the header has " +
                                                     std::to_string(field_count_));
    }

    const CsvLayout& layout_;
    const std::string& file_;
    std::vector<CsvColumn>& columns_;
    fast_float::parse_options number_;
    std::ptrdiff_t field_count_ = 0;
    std::size_t block_rows_ = 0, capacity_ = 0, row_ = 0;
    std::vector<double> block_;
    std::vector<std::string> fields_;
    const char* p_ = nullptr;
    const char* end_ = nullptr;
};

}  // namespace

void readCsvBody(const CsvLayout& layout, const std::string& file, std::vector<CsvColumn>& columns) {
    BodyReader(layout, file, columns).read();
}

namespace {

std::vector<OfferedColumn> listColumns(const CsvLayout& layout) {
    std::vector<OfferedColumn> offered;
    offered.reserve(layout.headers.size());
    for (std::size_t i = 0; i < layout.headers.size(); ++i) {
        OfferedColumn column{layout.headers[i], {}, {}};
        if (!layout.units.empty() && !layout.units[i].empty()) column.unit = layout.units[i];
        offered.push_back(std::move(column));
    }
    return offered;
}

/// Empty fields are left to the repair, but for time.
void checkFinite(const CsvColumn& column, const std::string& file, long first_row) {
    for (std::size_t i = 0; i < column.values.size(); ++i) {
        const InputLocation location{file, first_row + static_cast<long>(i), column.name};
        if (std::isinf(column.values[i])) throw InputError(location, "the value is too large");
        if (column.name == kTime && std::isnan(column.values[i])) throw InputError(location, "the row has no time");
    }
}

void append(std::vector<double>& more, std::vector<double>& values) {
    if (values.empty()) {
        values = std::move(more);
    } else {
        values.insert(values.end(), more.begin(), more.end());
    }
}

}  // namespace

CsvPlan planCsv(std::string_view text, const std::string& file, const ColumnMap* map) {
    CsvPlan plan;
    plan.layout = readCsvLayout(text, file, map);
    CsvLayout& layout = plan.layout;
    Recording& recording = plan.recording;
    recording.file = file;
    recording.format = "CSV";
    recording.metadata = std::move(layout.metadata);
    recording.first_row = layout.first_row;
    recording.warnings = std::move(layout.warnings);
    auto selection = selectColumns(listColumns(layout), file, layout.header_row, map, MissingUnit::error);
    recording.unused_columns = std::move(selection.unused);
    for (auto& selected : selection.columns) {
        CsvColumn column;
        column.index = static_cast<int>(selected.index);
        column.name = selected.name;
        column.scale = selected.scale;
        column.offset = selected.offset;
        plan.columns.push_back(std::move(column));
        if (selected.name == kTime) continue;
        recording.channels.push_back({selected.name, selected.unit, {}, static_cast<int>(selected.index) + 1});
    }
    return plan;
}

std::size_t appendRows(CsvPlan& plan, Recording& recording) {
    readCsvBody(plan.layout, recording.file, plan.columns);
    const std::size_t rows = plan.columns.front().values.size();
    std::size_t next = 0;
    for (auto& column : plan.columns) {
        if (column.has_non_finite) checkFinite(column, recording.file, plan.layout.first_row);
        column.has_non_finite = false;
        append(column.values, column.name == kTime ? recording.time : recording.channels[next++].values);
    }
    return rows;
}

Recording parseRecording(std::string_view text, const std::string& file, const ColumnMap* map) {
    // Spreadsheets' "Unicode text".
    if (const std::string decoded = decodeUtf16(text); !decoded.empty()) return parseRecording(decoded, file, map);
    CsvPlan plan = planCsv(text, file, map);
    appendRows(plan, plan.recording);
    finishRecording(plan.recording, map, false);
    return std::move(plan.recording);
}

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
