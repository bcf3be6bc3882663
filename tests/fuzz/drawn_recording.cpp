#include "tests/fuzz/drawn_recording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

namespace wems::fuzz {
namespace {

using Column = DrawnRecording::Column;
using Oddity = void (*)(DrawnRecording&, DrawnBytes&);

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::array<double, 16> kFactors{-1,    0,    1e3,   1e-3,   9.80665, 1 / 9.80665, 1e6,  1e-6,
                                          1e-12, 1e12, 1e150, 1e-150, 1e300,   1e-300,      0.99, 2};
constexpr std::array<double, 12> kCells{kNone, 0, 1e308, -1e308, kInfinite, 1e-308, 1e30, 1, -1, 1e6, 1e12, 1e-9};

bool isEmpty(const DrawnRecording& recording) {
    return recording.columns.size() < 2 || recording.columns.front().values.empty();
}

std::vector<double>& drawChannel(DrawnRecording& recording, DrawnBytes& bytes) {
    return recording.columns[1 + bytes.below(recording.columns.size() - 1)].values;
}

void dropChannels(DrawnRecording& recording, DrawnBytes& bytes) {
    for (std::size_t left = 1 + bytes.below(8); left > 0 && recording.columns.size() > 1; --left)
        recording.columns.erase(recording.columns.begin() +
                                static_cast<std::ptrdiff_t>(1 + bytes.below(recording.columns.size() - 1)));
}

/// Those whose names contain a drawn text.
void keepSome(DrawnRecording& recording, DrawnBytes& bytes) {
    static const std::array<std::string, 12> parts{"mobile", "fixed", "load", ".x", ".y",       ".z",
                                                   ".a",     ".az",   "1.",   "2.", "mobile.1", "relative"};
    const std::string part = bytes.pick(parts);
    auto& columns = recording.columns;
    columns.erase(std::remove_if(columns.begin() + 1, columns.end(),
                                 [&](const Column& column) { return column.name.find(part) == std::string::npos; }),
                  columns.end());
}

void scaleChannel(DrawnRecording& recording, DrawnBytes& bytes) {
    std::vector<double>& values = drawChannel(recording, bytes);
    const double factor = bytes.pick(kFactors);
    for (double& value : values) value *= factor;
}

void scaleSide(DrawnRecording& recording, DrawnBytes& bytes) {
    static const std::array<std::string, 8> sides{"mobile", "fixed", "load", ".a", ".z", ".x", "1.", ""};
    const std::string side = bytes.pick(sides);
    const double factor = bytes.pick(kFactors);
    for (std::size_t c = 1; c < recording.columns.size(); ++c)
        if (recording.columns[c].name.find(side) != std::string::npos)
            for (double& value : recording.columns[c].values) value *= factor;
}

void holdChannels(DrawnRecording& recording, DrawnBytes& bytes) {
    const double value = bytes.pick(kCells);
    for (std::size_t left = 1 + bytes.below(recording.columns.size() - 1); left > 0; --left)
        for (double& cell : drawChannel(recording, bytes)) cell = value;
}

void changeCells(DrawnRecording& recording, DrawnBytes& bytes) {
    const double value = bytes.pick(kCells);
    for (std::size_t left = 1 + bytes.below(16); left > 0; --left) {
        std::vector<double>& values = drawChannel(recording, bytes);
        values[bytes.below(values.size())] = value;
    }
}

void cutGap(DrawnRecording& recording, DrawnBytes& bytes) {
    std::vector<double>& values = drawChannel(recording, bytes);
    const std::size_t from = bytes.below(values.size());
    const std::size_t to = std::min(values.size(), from + 1 + bytes.below(values.size()));
    std::fill(values.begin() + static_cast<std::ptrdiff_t>(from), values.begin() + static_cast<std::ptrdiff_t>(to),
              kNone);
}

void repeatChannel(DrawnRecording& recording, DrawnBytes& bytes) {
    const std::vector<double> values = drawChannel(recording, bytes);
    drawChannel(recording, bytes) = values;
}

void reverse(DrawnRecording& recording, DrawnBytes& bytes) {
    if (bytes.below(2) == 0) {
        std::vector<double>& values = drawChannel(recording, bytes);
        std::reverse(values.begin(), values.end());
        return;
    }
    for (std::size_t c = bytes.below(2); c < recording.columns.size(); ++c)
        std::reverse(recording.columns[c].values.begin(), recording.columns[c].values.end());
}

void clip(DrawnRecording& recording, DrawnBytes& bytes) {
    std::vector<double>& values = drawChannel(recording, bytes);
    double largest = 0;
    for (const double value : values)
        if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    const double level = largest * static_cast<double>(bytes.below(256)) / 256;
    for (double& value : values) value = std::clamp(value, -level, level);
}

void addNoise(DrawnRecording& recording, DrawnBytes& bytes) {
    const bool all = bytes.below(2) == 1;
    const double level = std::pow(10.0, static_cast<double>(bytes.below(16)) - 10);
    std::mt19937 generator(static_cast<unsigned>(bytes.byte()));
    std::uniform_real_distribution<double> noise(-level, level);
    if (!all)
        for (double& value : drawChannel(recording, bytes)) value += noise(generator);
    for (std::size_t c = 1; all && c < recording.columns.size(); ++c)
        for (double& value : recording.columns[c].values) value += noise(generator);
}

void shift(DrawnRecording& recording, DrawnBytes& bytes) {
    std::vector<double>& values = drawChannel(recording, bytes);
    std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(bytes.below(values.size())), values.end());
}

void changeTime(DrawnRecording& recording, DrawnBytes& bytes) {
    std::vector<double>& time = recording.columns.front().values;
    const std::size_t at = bytes.below(time.size());
    switch (bytes.below(7)) {
        case 0:
            for (double& t : time) t *= 1e3;
            return;
        case 1: {
            const double factor = bytes.pick(kFactors);
            for (double& t : time) t *= factor;
            return;
        }
        case 2: {
            const double offset = bytes.pick(kCells);
            for (double& t : time) t += offset;
            return;
        }
        case 3: {
            const double jump = bytes.pick(kCells);
            for (std::size_t k = at; k < time.size(); ++k) time[k] += jump;
            return;
        }
        case 4:
            time[at] = time[at > 0 ? at - 1 : 0];
            return;
        case 5: {
            std::mt19937 generator(static_cast<unsigned>(bytes.byte()));
            std::uniform_real_distribution<double> jitter(-5e-3, 5e-3);
            for (double& t : time) t += jitter(generator);
            return;
        }
        default:
            for (double& t : time) t = t * t;
    }
}

void cutRows(DrawnRecording& recording, DrawnBytes& bytes) {
    const std::size_t count = recording.columns.front().values.size();
    const std::size_t first = bytes.below(2) == 0 ? 0 : bytes.below(count);
    const std::size_t kept = std::min(count - first, bytes.below(bytes.below(2) == 0 ? 16 : count + 1));
    for (Column& column : recording.columns) {
        column.values.erase(column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(first));
        column.values.resize(kept);
    }
}

void keepEvery(DrawnRecording& recording, DrawnBytes& bytes) {
    const std::size_t step = 2 + bytes.below(30);
    for (Column& column : recording.columns) {
        std::vector<double> kept;
        for (std::size_t k = 0; k < column.values.size(); k += step) kept.push_back(column.values[k]);
        column.values = std::move(kept);
    }
}

void repeatRows(DrawnRecording& recording, DrawnBytes& bytes) {
    const std::size_t count = recording.columns.front().values.size(), from = bytes.below(count);
    const std::size_t length = std::min<std::size_t>(count - from, 1 + bytes.below(100)), to = bytes.below(count);
    const std::size_t first = bytes.below(2);  // the stamps, too, or not
    for (std::size_t c = first; c < recording.columns.size(); ++c) {
        std::vector<double>& values = recording.columns[c].values;
        for (std::size_t k = 0; k < length && to + k < count; ++k) values[to + k] = values[from + k];
    }
}

/// As a converter of few bits does.
void quantise(DrawnRecording& recording, DrawnBytes& bytes) {
    const double step = std::pow(10.0, static_cast<double>(bytes.below(12)) - 9);
    for (double& value : drawChannel(recording, bytes)) value = step * std::round(value / step);
}

void changeUnit(DrawnRecording& recording, DrawnBytes& bytes) {
    static const std::array<std::string, 14> units{"mm", "um", "m", "in", "m/s", "g",       "mm/s^2",
                                                   "N",  "kN", "s", "ms", "",    "furlong", "m/s^2"};
    recording.columns[bytes.below(recording.columns.size())].unit = bytes.pick(units);
}

void rename(DrawnRecording& recording, DrawnBytes& bytes) {
    static const std::array<std::string, 16> names{
        "mobile.1.x", "mobile.1.z", "mobile.2.z", "fixed.1.z",    "fixed.1.az", "mobile.1.az", "mobile.9.z",  "load.fz",
        "load.fx",    "base.az",    "base.ax",    "relative.1.z", "force.1.z",  "time",        "mobile.1.vz", "strain"};
    recording.columns[bytes.below(recording.columns.size())].name = bytes.pick(names);
}

}  // namespace

void makeOdd(DrawnRecording& recording, DrawnBytes& bytes) {
    static const std::array<Oddity, 18> oddities{dropChannels, keepSome, scaleChannel,  scaleSide, holdChannels,
                                                 changeCells,  cutGap,   repeatChannel, reverse,   clip,
                                                 addNoise,     shift,    changeTime,    cutRows,   keepEvery,
                                                 repeatRows,   quantise, changeUnit};
    for (std::size_t left = bytes.below(5); left > 0 && !isEmpty(recording); --left) {
        const std::size_t which = bytes.below(oddities.size() + 1);
        (which == oddities.size() ? rename : oddities[which])(recording, bytes);
    }
}

std::string damage(std::string text, DrawnBytes& bytes) {
    for (std::size_t left = bytes.below(5); left > 0 && !text.empty(); --left) {
        const std::size_t at = bytes.below(text.size());
        switch (bytes.below(4)) {
            case 0:
                text.resize(at);
                break;
            case 1:
                text.insert(at, 1, static_cast<char>(bytes.byte()));
                break;
            case 2:
                text.erase(at, 1 + bytes.byte());
                break;
            default:
                text[at] = static_cast<char>(bytes.byte());
        }
    }
    return text;
}

std::string DrawnRecording::formatCsv() const {
    std::string text;
    for (const Column& column : columns)
        text += (text.empty() ? "" : ",") + column.name + (column.unit.empty() ? "" : " [" + column.unit + "]");
    text += "\n";
    std::array<char, 32> field{};
    for (std::size_t k = 0; k < columns.front().values.size(); ++k)
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const double value = columns[c].values[k];
            if (!std::isnan(value)) {
                std::snprintf(field.data(), field.size(), c == 0 ? "%.12g" : "%.7g", value);
                text += field.data();
            }
            text += c + 1 < columns.size() ? "," : "\n";
        }
    return text;
}

}  // namespace wems::fuzz
