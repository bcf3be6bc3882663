#include "models/recording/csv_body.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/error.hpp"
#include "models/recording/number_parser.hpp"

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
        : layout_(layout), file_(file), columns_(columns), parser_(layout.decimal, layout.separator) {
        field_count_ = static_cast<std::ptrdiff_t>(layout.headers.size());
        block_rows_ = std::clamp<std::size_t>(kBlockNumbers / columns.size(), 8, 128);
        block_.resize(block_rows_ * columns.size());
    }

    void read() {
        p_ = layout_.body.data();
        end_ = p_ + layout_.body.size();
        fast_from_ = p_ + std::min<std::ptrdiff_t>(8, end_ - p_);
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
            const char* stop = p >= fast_from_ ? parser_.parseField(p, end_, row[k]) : nullptr;
            p = stop != nullptr ? stop : readField(p, columns_[k], row[k]);
            column = columns_[k].index;
        }
        p_ = p;
        finishRow(column);
    }

    /// The general way: any spelling of a number, spaces around it, an empty field. Returns the field's end.
    const char* readField(const char* p, const CsvColumn& column, double& value) const {
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
        const fast_float::parse_options options(fast_float::chars_format::general, layout_.decimal);
        const auto result = fast_float::from_chars_advanced(first, last, value, options);
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
    NumberParser parser_;
    std::ptrdiff_t field_count_ = 0;
    std::size_t block_rows_ = 0, capacity_ = 0, row_ = 0;
    std::vector<double> block_;
    std::vector<std::string> fields_;
    const char* p_ = nullptr;
    const char* end_ = nullptr;
    const char* fast_from_ = nullptr;  // the parser of fields looks at eight bytes before
};

}  // namespace

void readCsvBody(const CsvLayout& layout, const std::string& file, std::vector<CsvColumn>& columns) {
    BodyReader(layout, file, columns).read();
}

}  // namespace wems
