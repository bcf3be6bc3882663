#include "models/recording/opensim_writer.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/recording/recording_writer.hpp"

namespace wems {
namespace {

constexpr double kMillimetres = 1e3;  // in a metre

/// Hands text to the file once there is enough of it.
void flushLarge(std::string& text, AtomicFile& file) {
    if (text.size() < kFlushSize) return;
    file.write(text);
    text.clear();
}

}  // namespace

TrcWriter::TrcWriter(const Recording& header, const RowPlan& plan, const std::string& file, const WriteOptions& options)
    : channel_count_(header.channels.size()), digits_(std::clamp(options.digits, 1, 17)) {
    listMarkers(header, options);
    if (markers_.empty())
        throw InputError({file, 0, {}},
                         "the recording has no displacements of mobile or fixed, and .trc holds nothing else",
                         ".csv or .sto");
    file_ = std::make_unique<AtomicFile>(file);
    file_->write(makeHeader(plan, file));
}

void TrcWriter::listMarkers(const Recording& header, const WriteOptions& options) {
    std::vector<std::string> left_out;
    for (std::size_t i = 0; i < header.channels.size(); ++i) {
        const Channel& channel = header.channels[i];
        const ChannelName name = parseValidName(channel);
        const bool position =
            name.derivative == Derivative::displacement && (name.part == Part::mobile || name.part == Part::fixed);
        if (!position) {
            left_out.push_back(channel.name);
            continue;
        }
        const std::string marker_name = channel.name.substr(0, channel.name.rfind('.'));
        auto marker = std::find_if(markers_.begin(), markers_.end(),
                                   [&](const Marker& other) { return other.name == marker_name; });
        if (marker == markers_.end()) {
            marker = markers_.insert(marker, Marker{marker_name, {-1, -1, -1}, {}});
            const auto rest = options.rest.find(name.connection);
            if (rest != options.rest.end()) std::copy(rest->second.begin(), rest->second.end(), marker->rest.begin());
        }
        marker->channels.at(name.axis) = static_cast<int>(i);
    }
    if (!left_out.empty())
        notes_.push_back(".trc holds positions only: " + std::to_string(left_out.size()) + " channels are left out (" +
                         left_out.front() + (left_out.size() > 1 ? " …)" : ")"));
}

std::string TrcWriter::makeHeader(const RowPlan& plan, const std::string& file) const {
    const std::string rate = formatNumber(plan.interval > 0 ? 1 / plan.interval : 1.0, 9);
    const std::string count = std::to_string(plan.count);
    std::string text = "PathFileType\t4\t(X/Y/Z)\t" + std::filesystem::path(file).filename().string() + "\n";
    text += "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n";
    text += rate + "\t" + rate + "\t" + count + "\t" + std::to_string(markers_.size()) + "\tmm\t" + rate + "\t1\t" +
            count + "\n";
    text += "Frame#\tTime";
    std::string axes = "\t";
    for (std::size_t i = 0; i < markers_.size(); ++i) {
        const std::string number = std::to_string(i + 1);
        text += "\t" + markers_[i].name + (i + 1 < markers_.size() ? "\t\t" : "");
        for (const char* axis : {"X", "Y", "Z"}) axes += std::string("\t") + axis + number;
    }
    return text + "\n" + axes + "\n\n";
}

void TrcWriter::append(const Recording& rows) {
    checkRows(rows, channel_count_);
    std::string text;
    for (std::size_t i = 0; i < rows.time.size(); ++i) {
        text += std::to_string(++frames_) + "\t";
        appendNumber(rows.time[i], std::max(digits_, kTimeDigits), text);
        for (const Marker& marker : markers_) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                text += '\t';
                const int channel = marker.channels.at(axis);
                if (channel < 0) continue;
                const double value = rows.channels[channel].values[i];
                if (!std::isnan(value))
                    appendNumber(kMillimetres * (marker.rest.at(axis) + value), std::min(digits_ + 3, 17), text);
            }
        }
        text += '\n';
        flushLarge(text, *file_);
    }
    file_->write(text);
}

std::unique_ptr<AtomicFile> TrcWriter::finish() {
    file_->finish();
    return std::move(file_);
}

StorageWriter::StorageWriter(const Recording& header, const RowPlan& plan, const std::string& file, int digits)
    : channel_count_(header.channels.size()), digits_(std::clamp(digits, 1, 17)) {
    std::string text = std::filesystem::path(file).stem().string() + "\n";
    for (const auto& [key, value] : header.metadata) {
        std::string line = key + "=" + value;
        std::replace_if(
            line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
        text += line + "\n";
    }
    text += "DataType=double\nversion=3\ninDegrees=no\nunits=SI\nnRows=" + std::to_string(plan.count) +
            "\nnColumns=" + std::to_string(header.channels.size() + 1) + "\nendheader\ntime";
    for (const Channel& channel : header.channels) {
        parseValidName(channel);
        text += "\t" + channel.name;
    }
    file_ = std::make_unique<AtomicFile>(file);
    file_->write(text + "\n");
}

void StorageWriter::append(const Recording& rows) {
    checkRows(rows, channel_count_);
    std::string text;
    for (std::size_t i = 0; i < rows.time.size(); ++i) {
        appendNumber(rows.time[i], std::max(digits_, kTimeDigits), text);
        for (const Channel& channel : rows.channels) {
            text += '\t';
            appendNumber(channel.values[i], digits_, text);
        }
        text += '\n';
        flushLarge(text, *file_);
    }
    file_->write(text);
}

std::unique_ptr<AtomicFile> StorageWriter::finish() {
    file_->finish();
    return std::move(file_);
}

}  // namespace wems
