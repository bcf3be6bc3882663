#include "models/recording/recording_stream.hpp"

#include <algorithm>
#include <filesystem>

#include "models/error.hpp"

namespace wems {
namespace {

constexpr std::size_t kChunk = 4U << 20U;        // bytes
constexpr std::size_t kLongestRow = 64U << 20U;  // bytes

/// Rows of `text`, the last one with or without its line end.
std::size_t countRows(std::string_view text) {
    const auto ends = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    return ends + (text.empty() || text.back() == '\n' ? 0 : 1);
}

bool isBlank(std::string_view text, char separator) {
    const char blank[] = {' ', '\t', '\r', '\n', separator};
    return text.find_first_not_of(std::string_view(blank, sizeof blank)) == std::string_view::npos;
}

}  // namespace

RecordingStream::RecordingStream(const std::string& file, const ColumnMap* map, std::size_t block_rows)
    : file_(file), map_(map), block_rows_(std::max<std::size_t>(2, block_rows)), input_(file, std::ios::binary) {
    if (!input_) throw InputError({file, 0, {}}, "cannot be opened");
    const std::string_view rows = readRows();
    plan_ = planCsv(rows, file, map);
    header_ = plan_.recording;
    const std::string_view body = plan_.layout.body;
    const auto rest = static_cast<double>(std::filesystem::file_size(file) - (rows.size() - body.size()));
    expected_samples_ = static_cast<double>(countRows(body)) * rest / static_cast<double>(body.size());
    parseRows();
}

/// Whole rows, at least one; none at the end of the file.
std::string_view RecordingStream::readRows() {
    text_.erase(0, parsed_text_);
    for (;;) {
        const std::size_t before = text_.size();
        text_.resize(before + kChunk);
        input_.read(&text_[before], static_cast<std::streamsize>(kChunk));
        text_.resize(before + static_cast<std::size_t>(input_.gcount()));
        if (input_.bad()) throw InputError({file_, 0, {}}, "cannot be read to its end");
        at_end_ = input_.eof();
        parsed_text_ = at_end_ ? text_.size() : text_.rfind('\n') + 1;  // 0 if there is none
        if (at_end_ || parsed_text_ > 0) return std::string_view(text_).substr(0, parsed_text_);
        if (text_.size() > kLongestRow)
            throw InputError({file_, plan_.layout.first_row, {}}, "a row is longer than 64 MB");
    }
}

/// Parses the rows of the layout's body, which readRows() has read.
void RecordingStream::parseRows() {
    CsvLayout& layout = plan_.layout;
    if (isBlank(layout.body, layout.separator)) {
        past_rows_ = past_rows_ || !layout.body.empty();
        return;
    }
    if (past_rows_) throw InputError({file_, layout.first_row, {}}, "blank row inside the data");
    layout.has_quotes = layout.body.find('"') != std::string_view::npos;
    const std::size_t rows = appendRows(plan_);
    layout.first_row += static_cast<long>(rows);
    past_rows_ = rows < countRows(layout.body);
}

std::size_t RecordingStream::pendingRows() const {
    return plan_.recording.channels.front().values.size();
}

bool RecordingStream::next(Recording& block) {
    const std::size_t enough = block_rows_ + block_rows_ / 2;
    while (pendingRows() < enough && !at_end_) {
        plan_.layout.body = readRows();
        parseRows();
    }
    if (pendingRows() == (is_first_ ? 0U : 1U)) return false;
    cutBlock(pendingRows() < enough ? pendingRows() : block_rows_, block);
    const std::size_t rows = block.channels.front().values.size();
    finishBlock(block, map_, false, state_);
    state_.first_sample += rows - 1;
    checkSameChannels(block);
    is_first_ = false;
    return true;
}

/// Moves the first rows into `block`; the last of them stays too.
void RecordingStream::cutBlock(std::size_t rows, Recording& block) {
    Recording& pending = plan_.recording;
    block = header_;
    block.first_row = pending.first_row;
    if (!is_first_) block.warnings.clear();
    const auto take = [rows](std::vector<double>& from, std::vector<double>& to) {
        if (from.empty()) return;  // samples are numbered
        to.assign(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(rows));
        from.erase(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(rows - 1));
    };
    take(pending.time, block.time);
    for (std::size_t c = 0; c < pending.channels.size(); ++c)
        take(pending.channels[c].values, block.channels[c].values);
    pending.first_row += static_cast<long>(rows) - 1;
}

void RecordingStream::checkSameChannels(const Recording& block) {
    std::vector<std::string> names;
    for (const Channel& channel : block.channels) names.push_back(channel.name);
    if (is_first_) channels_ = names;
    if (names == channels_) return;
    for (const Channel& channel : header_.channels) {
        const bool here = std::find(names.begin(), names.end(), channel.name) != names.end();
        const bool before = std::find(channels_.begin(), channels_.end(), channel.name) != channels_.end();
        if (here == before) continue;
        throw InputError({file_, block.first_row, channel.name},
                         here ? "has values from this row on and none before"
                              : "has no value in " + std::to_string(block.sampleCount()) + " rows on end",
                         "a channel that is recorded throughout, or not at all");
    }
}

}  // namespace wems
