#include "models/recording/opensim_rows.hpp"

#include <utility>

#include "models/recording/utf8.hpp"

namespace wems {
OpensimRows::OpensimRows(const std::string& file, const ColumnMap* map)
    : text_(file, TextFile::Pages::as_needed), lines_(skipByteOrderMark(text_.view())) {
    RecordingTable table = isTrc(lines_.rest()) ? readTrcHeader(lines_, file) : readStorageHeader(lines_, file);
    column_count_ = table.columns.size();
    plan_ = planTable(table, map);
    if (text_.view().back() != '\n') plan_.recording.warnings.emplace_back(kNoLineEnd);
    expected_samples_ = estimateRows(lines_.rest());
}

bool OpensimRows::append(Recording& rows) {
    if (lines_.atEnd()) {
        checkRowCount(plan_.recording.file, plan_.recording.metadata, lines_.line(), rows_read_);
        return false;
    }
    auto values = readNumberRows(lines_, column_count_, plan_.recording.file, kRowsAtOnce);
    rows_read_ += values.front().size();
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, std::move(values[plan_.columns[k].index]), rows);
    text_.release();
    return true;
}

}  // namespace wems
