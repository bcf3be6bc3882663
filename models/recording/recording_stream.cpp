#include "models/recording/recording_stream.hpp"

#include <algorithm>

#include "models/common/error.hpp"

namespace wems {

RecordingStream::RecordingStream(const std::string& file, const ColumnMap* map, std::size_t block_rows)
    : file_(file),
      map_(map),
      block_rows_(std::max<std::size_t>(2, block_rows)),
      source_(openRows(file, map)),
      pending_(source_->header()) {}

double RecordingStream::fractionRead() const {
    return std::min(1.0, static_cast<double>(state_.first_sample + 1) / expectedSamples());
}

std::size_t RecordingStream::pendingRows() const {
    return pending_.channels.front().values.size();
}

bool RecordingStream::next(Recording& block) {
    const std::size_t enough = block_rows_ + block_rows_ / 2;
    while (pendingRows() < enough && source_->append(pending_)) {
    }
    if (is_first_ && pendingRows() == 0) throw InputError({file_, 0, {}}, "there are no samples");
    if (!is_first_ && pendingRows() == 1) return false;
    cutBlock(pendingRows() < enough ? pendingRows() : block_rows_, block);
    const std::size_t rows = block.channels.front().values.size();
    finishBlock(block, map_, source_->hasPositions(), state_);
    state_.first_sample += rows - 1;
    checkSameChannels(block);
    is_first_ = false;
    return true;
}

/// Moves the first rows into `block`; the last of them stays too.
void RecordingStream::cutBlock(std::size_t rows, Recording& block) {
    block = header();
    block.first_row = pending_.first_row;
    if (!is_first_) block.warnings.clear();
    const auto take = [rows](std::vector<double>& from, std::vector<double>& to) {
        if (from.empty()) return;  // samples are numbered
        to.assign(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(rows));
        from.erase(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(rows - 1));
    };
    take(pending_.time, block.time);
    for (std::size_t c = 0; c < pending_.channels.size(); ++c)
        take(pending_.channels[c].values, block.channels[c].values);
    pending_.first_row += static_cast<long>(rows) - 1;
}

void RecordingStream::checkSameChannels(const Recording& block) {
    std::vector<std::string> names;
    for (const Channel& channel : block.channels) names.push_back(channel.name);
    if (is_first_) channels_ = names;
    if (names == channels_) return;
    for (const Channel& channel : header().channels) {
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
