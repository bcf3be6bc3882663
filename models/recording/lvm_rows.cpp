#include "models/recording/lvm_rows.hpp"

#include <utility>

#include "models/recording/utf8.hpp"

namespace wems {
LvmRows::LvmRows(const std::string& file, const ColumnMap* map)
    : text_(file, TextFile::Pages::as_needed), lines_(skipByteOrderMark(text_.view())) {
    LvmHeader header = readLvmHeader(lines_, file);
    form_ = header.form;
    if (form_.packet > 0 && exceedsPacket()) header.table.warnings.push_back(describePackets(form_));
    plan_ = planTable(header.table, map);
    expected_samples_ = estimateRows(lines_.rest());
}

/// Walks over the first packet.
bool LvmRows::exceedsPacket() const {
    LineCursor rows = lines_;
    for (std::size_t k = 0; k < form_.packet; ++k) {
        if (rows.atEnd()) return false;
        rows.take();
        if (k % kRowsAtOnce == 0) text_.release();
    }
    return rows.rest().find_first_not_of(" \t\r\n,") != std::string_view::npos;
}

bool LvmRows::append(Recording& rows) {
    if (lines_.atEnd()) return false;
    auto values = readLvmRows(lines_, form_, plan_.recording.file, samples_read_, kRowsAtOnce);
    samples_read_ += values.front().size();
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, std::move(values[plan_.columns[k].index]), rows);
    text_.release();
    return true;
}

}  // namespace wems
