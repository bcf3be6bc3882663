#include "models/recording/uff_rows.hpp"

#include <algorithm>

#include "models/error.hpp"
#include "models/recording/utf8.hpp"

namespace wems {
namespace {

constexpr std::size_t kPointsAtOnce = 8192;

}  // namespace

UffRows::UffRows(const std::string& file, const ColumnMap* map) : file_(file), text_(file, TextFile::Pages::as_needed) {
    UffIndex index = indexUniversalFile(skipByteOrderMark(text_.view()), file_, [this] { text_.release(); });
    plan_ = planTable(index.table.table, map);
    const auto open = [&](std::size_t function) {
        series_.push_back(
            {index.functions[function], UffNumberReader(index.functions[function], index.extents[function], file_)});
    };
    // The time is that of the first function, whichever are used.
    open(index.table.functions.front());
    for (const SelectedColumn& column : plan_.columns) {
        const std::size_t function = column.index == 0 ? 0 : column.index - 1;
        used_.push_back(function == 0 ? 0 : series_.size());
        if (function != 0) open(index.table.functions[function]);
    }
    point_count_ = series_.front().function.points;
    text_.release();
}

bool UffRows::append(Recording& rows) {
    const std::size_t points = std::min(kPointsAtOnce, point_count_ - points_read_);
    if (points == 0) return false;
    for (Series& series : series_) series.reader.read(points_read_ + points, series.function);
    UffFunction& first = series_.front().function;
    std::vector<double> time(points);
    for (std::size_t i = 0; i < points; ++i) time[i] = first.even ? first.time(points_read_ + i) : first.abscissa[i];
    for (Series& series : series_) {
        auto& abscissa = series.function.abscissa;
        if (first.even) continue;
        if (!std::equal(time.begin(), time.end(), abscissa.begin()))
            throw InputError({file_, static_cast<long>(points_read_) + 1, series.function.name()},
                             "its times are not those of " + first.name(),
                             "responses of the same times in a recording that is longer than the memory");
        abscissa.erase(abscissa.begin(), abscissa.begin() + static_cast<std::ptrdiff_t>(points));
    }
    std::vector<std::vector<double>> values;
    for (Series& series : series_) values.push_back(takeValues(series, points));
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, plan_.columns[k].index == 0 ? time : values[used_[k]], rows);
    points_read_ += points;
    text_.release();
    return true;
}

std::vector<double> UffRows::takeValues(Series& series, std::size_t points) const {
    auto& pending = series.function.values;
    const auto end = pending.begin() + static_cast<std::ptrdiff_t>(points);
    std::vector<double> values(pending.begin(), end);
    pending.erase(pending.begin(), end);
    return values;
}

}  // namespace wems
