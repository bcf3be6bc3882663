#include "models/recording/opensim_writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "models/atomic_file.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/recording/number_writer.hpp"

namespace wems {
namespace {

void checkChannels(const Recording& recording) {
    for (const auto& channel : recording.channels) {
        if (!parseChannelName(channel.name) || channel.values.size() != recording.time.size())
            throw std::invalid_argument("writeRecording: channel '" + channel.name + "' has no valid name or length");
    }
}

/// Collects text and hands it to the file in large pieces.
class Output {
public:
    explicit Output(const std::string& file)
        : name_(file), file_(file), stream_(file_.temporaryPath(), std::ios::binary | std::ios::trunc) {}

    std::string& text() { return text_; }
    void flush(std::size_t least) {
        if (text_.size() < least) return;
        stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
        text_.clear();
    }
    void finish() {
        flush(0);
        stream_.close();
        if (!stream_) throw InputError({name_, 0, {}}, "could not be written completely; is the disk full?");
        file_.commit();
    }

private:
    std::string name_;
    AtomicFile file_;
    std::ofstream stream_;
    std::string text_;
};

/// A marker and its three displacement channels, null where there is none.
struct Marker {
    std::string name, connection;
    std::array<const Channel*, 3> axes{};
};

std::vector<Marker> listMarkers(const Recording& recording, std::vector<std::string>& left_out) {
    std::vector<Marker> markers;
    for (const auto& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        const bool position =
            name->derivative == Derivative::displacement && (name->part == Part::mobile || name->part == Part::fixed);
        if (!position) {
            left_out.push_back(channel.name);
            continue;
        }
        const std::string marker_name = channel.name.substr(0, channel.name.rfind('.'));
        auto marker = std::find_if(markers.begin(), markers.end(),
                                   [&](const Marker& other) { return other.name == marker_name; });
        if (marker == markers.end()) marker = markers.insert(marker, Marker{marker_name, name->connection, {}});
        marker->axes.at(static_cast<std::size_t>(name->axis)) = &channel;
    }
    return markers;
}

std::string makeTrcHeader(const Recording& recording, const std::string& file, const std::vector<Marker>& markers) {
    const double interval = recording.sampleInterval();
    const std::string rate = formatNumber(interval > 0 ? 1 / interval : 1.0, 9);
    const std::string count = std::to_string(recording.sampleCount());
    std::string text = "PathFileType\t4\t(X/Y/Z)\t" + std::filesystem::path(file).filename().string() + "\n";
    text += "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n";
    text += rate + "\t" + rate + "\t" + count + "\t" + std::to_string(markers.size()) + "\tmm\t" + rate + "\t1\t" +
            count + "\n";
    text += "Frame#\tTime";
    std::string axes = "\t";
    for (std::size_t i = 0; i < markers.size(); ++i) {
        const std::string number = std::to_string(i + 1);
        text += "\t" + markers[i].name + (i + 1 < markers.size() ? "\t\t" : "");
        for (const char* axis : {"X", "Y", "Z"}) axes += std::string("\t") + axis + number;
    }
    return text + "\n" + axes + "\n\n";
}

}  // namespace

std::vector<std::string> writeTrc(const Recording& recording, const std::string& file, const WriteOptions& options) {
    checkChannels(recording);
    std::vector<std::string> left_out, notes;
    const auto markers = listMarkers(recording, left_out);
    if (markers.empty())
        throw InputError({file, 0, {}},
                         "the recording has no displacements of mobile or fixed, and .trc holds nothing else",
                         ".csv or .sto");
    if (!left_out.empty())
        notes.push_back(".trc holds positions only: " + std::to_string(left_out.size()) + " channels are left out (" +
                        left_out.front() + (left_out.size() > 1 ? " …)" : ")"));
    const int digits = std::clamp(options.digits, 1, 17);
    Output output(file);
    output.text() = makeTrcHeader(recording, file, markers);
    for (std::size_t i = 0; i < recording.time.size(); ++i) {
        std::string& text = output.text();
        text += std::to_string(i + 1) + "\t";
        appendNumber(recording.time[i], std::max(digits, kTimeDigits), text);
        for (const auto& marker : markers) {
            const auto rest = options.rest.find(marker.connection);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                text += '\t';
                const Channel* channel = marker.axes.at(axis);
                if (channel == nullptr || std::isnan(channel->values[i])) continue;
                const double origin = rest == options.rest.end() ? 0.0 : rest->second[static_cast<Eigen::Index>(axis)];
                appendNumber(1e3 * (origin + channel->values[i]), std::min(digits + 3, 17), text);
            }
        }
        text += '\n';
        output.flush(kFlushSize);
    }
    output.finish();
    return notes;
}

void writeStorage(const Recording& recording, const std::string& file, const WriteOptions& options) {
    checkChannels(recording);
    const int digits = std::clamp(options.digits, 1, 17);
    Output output(file);
    std::string& text = output.text();
    text += std::filesystem::path(file).stem().string() + "\n";
    for (const auto& [key, value] : recording.metadata) {
        std::string line = key + "=" + value;
        std::replace_if(
            line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
        text += line + "\n";
    }
    text += "DataType=double\nversion=3\ninDegrees=no\nunits=SI\nnRows=" + std::to_string(recording.time.size()) +
            "\nnColumns=" + std::to_string(recording.channels.size() + 1) + "\nendheader\ntime";
    for (const auto& channel : recording.channels) text += "\t" + channel.name;
    text += '\n';
    for (std::size_t i = 0; i < recording.time.size(); ++i) {
        appendNumber(recording.time[i], std::max(digits, kTimeDigits), text);
        for (const auto& channel : recording.channels) {
            text += '\t';
            appendNumber(channel.values[i], digits, text);
        }
        text += '\n';
        output.flush(kFlushSize);
    }
    output.finish();
}

}  // namespace wems
