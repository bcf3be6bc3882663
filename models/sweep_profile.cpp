#include "models/sweep_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"
#include "models/common/units.hpp"
#include "models/power_spectrum.hpp"

namespace wems {
namespace {

constexpr const char* kAcceptedLevels =
    "amplitudes above 0 with a unit: displacement (m, mm, um, in), velocity (m/s, mm/s, in/s), acceleration (m/s^2, g) "
    "or force (N, kN, lbf)";
constexpr double kTransition = 0.6931471805599453 / 48;  // in ln f: half of a 24th of an octave

/// Acceleration (m/s²) of a sine with that amplitude; a force stays what it is.
double toAcceleration(double level, Quantity quantity, double frequency) {
    const double omega = kTwoPi * frequency;
    if (quantity == Quantity::length) return level * omega * omega;
    return quantity == Quantity::velocity ? level * omega : level;
}

double calcLevelOf(const ProfileSegment& segment, double frequency) {
    const double share = std::log(frequency / segment.from) / std::log(segment.to / segment.from);
    return toAcceleration(segment.start_level * std::pow(segment.end_level / segment.start_level, share),
                          segment.quantity, frequency);
}

struct ReadLevel {
    double value;
    Quantity quantity;
};

ReadLevel readLevel(std::string_view cell, const InputLocation& location) {
    const std::string text(cell);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const std::string unit = end;
    if (end != text.c_str() && std::isfinite(value) && value > 0 && !unit.empty())
        for (const Quantity quantity : {Quantity::acceleration, Quantity::length, Quantity::velocity, Quantity::force})
            try {
                return {value * findUnitFactor(unit, quantity, location), quantity};
            } catch (const InputError&) {
                continue;  // a unit of another quantity
            }
    throw InputError(location, "`" + text + "` is no level", kAcceptedLevels);
}

double readFrequency(std::string_view cell, const InputLocation& location) {
    const std::string text(cell);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !(value > 0 && std::isfinite(value)))
        throw InputError(location, "`" + text + "` is no frequency", "Hz, above 0");
    return value;
}

class ProfiledSweep : public Signal {
public:
    ProfiledSweep(std::shared_ptr<const Signal> sweep, SweepProfile profile, Fade fade)
        : sweep_(std::move(sweep)), profile_(std::move(profile)), fade_(fade) {}
    double duration() const override { return sweep_->duration(); }
    double value(double t) const override {
        if (!(t >= 0 && t <= duration())) return 0;
        const double sine = std::sin(sweep_->phase(t)), cosine = std::cos(sweep_->phase(t));
        if (profile_.isForce()) return calcFade(t) * profile_.calcLevel(sweep_->frequency(t)) * sine;
        // The amplitude changes within tenths of a second, the swept frequency over the run.
        constexpr double step = 1e-4;  // s
        const double before = calcAmplitude(t - step), now = calcAmplitude(t), after = calcAmplitude(t + step);
        const double first = (after - before) / (2 * step), second = (after - 2 * now + before) / (step * step);
        const double omega = kTwoPi * sweep_->frequency(t);
        const double long_step = 1e-4 * duration();
        const double rate =
            kTwoPi * (sweep_->frequency(t + long_step) - sweep_->frequency(t - long_step)) / (2 * long_step);
        return second * sine + 2 * first * omega * cosine + now * (rate * cosine - omega * omega * sine);
    }
    double phase(double t) const override { return sweep_->phase(t); }
    double frequency(double t) const override { return sweep_->frequency(t); }
    double highestFrequency() const override { return sweep_->highestFrequency(); }
    std::optional<Integrals> integralsAtStart() const override {
        if (profile_.isForce()) return std::nullopt;
        return Integrals{calcAmplitude(0) * kTwoPi * sweep_->frequency(0), 0};
    }

private:
    double calcFade(double t) const {
        double weight = 1;
        if (fade_.start > 0 && t < fade_.start) weight *= 0.5 * (1 - std::cos(kPi * std::max(0.0, t) / fade_.start));
        const double left = duration() - t;
        if (fade_.end > 0 && left < fade_.end) weight *= 0.5 * (1 - std::cos(kPi * std::max(0.0, left) / fade_.end));
        return weight;
    }
    /// Of the displacement, m.
    double calcAmplitude(double t) const {
        const double omega = kTwoPi * sweep_->frequency(t);
        return calcFade(t) * profile_.calcLevel(sweep_->frequency(t)) / (omega * omega);
    }

    std::shared_ptr<const Signal> sweep_;
    SweepProfile profile_;
    Fade fade_;
};

}  // namespace

SweepProfile::SweepProfile(std::vector<ProfileSegment> segments) : segments_(std::move(segments)) {
    if (segments_.empty()) throw InputError({{}, 0, "profile"}, "has no row", "rows of from, to (Hz) and a level");
    std::sort(segments_.begin(), segments_.end(),
              [](const ProfileSegment& a, const ProfileSegment& b) { return a.from < b.from; });
    force_ = segments_.front().quantity == Quantity::force;
    lowest_ = segments_.front().from;
    for (const ProfileSegment& segment : segments_) {
        if (!(segment.from > 0 && segment.to > segment.from && segment.start_level > 0 && segment.end_level > 0))
            throw InputError({{}, 0, "profile"},
                             "has a row from " + formatNumber(segment.from) + " to " + formatNumber(segment.to) + " Hz",
                             "ascending frequencies and levels above 0");
        if (force_ != (segment.quantity == Quantity::force))
            throw InputError({{}, 0, "profile"}, "has rows of a force and of a motion", "rows of one of both");
        if (highest_ > 0 && segment.from > highest_)
            throw InputError(
                {{}, 0, "profile"},
                "leaves a gap from " + formatNumber(highest_) + " to " + formatNumber(segment.from) + " Hz",
                "a row that covers it");
        highest_ = std::max(highest_, segment.to);
    }
    // Where another row holds: between looks, by bisection.
    constexpr int looks = 2000, halvings = 60;
    for (int k = 0; k < looks; ++k) {
        double a = lowest_ * std::pow(highest_ / lowest_, static_cast<double>(k) / looks);
        double b = lowest_ * std::pow(highest_ / lowest_, static_cast<double>(k + 1) / looks);
        const std::size_t row = findRow(a);
        if (findRow(b) == row) continue;
        for (int i = 0; i < halvings; ++i) {
            const double middle = 0.5 * (a + b);
            (findRow(middle) == row ? a : b) = middle;
        }
        changes_.push_back(b);
    }
    constexpr double step = 1e-6;  // in ln f
    for (std::size_t i = 0; i < changes_.size(); ++i) {
        Passage passage;
        passage.at = std::log(changes_[i]);
        const double before = i > 0 ? std::log(changes_[i - 1]) : std::log(lowest_),
                     after = i + 1 < changes_.size() ? std::log(changes_[i + 1]) : std::log(highest_);
        // Neighbours may lie closer to each other.
        passage.width = std::min({kTransition, 0.45 * (passage.at - before), 0.45 * (after - passage.at)});
        for (const int side : {0, 1}) {
            const double end = passage.at + (side == 0 ? -1 : 1) * passage.width;
            passage.level[side] = std::log(calcSharp(std::exp(end)));
            passage.slope[side] =
                (std::log(calcSharp(std::exp(end + step))) - std::log(calcSharp(std::exp(end - step)))) / (2 * step);
        }
        passages_.push_back(passage);
    }
}

std::size_t SweepProfile::findRow(double frequency) const {
    std::size_t row = 0;
    double level = INFINITY;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        if (!(frequency >= segments_[i].from && frequency <= segments_[i].to)) continue;
        if (const double own = calcLevelOf(segments_[i], frequency); own < level) {
            level = own;
            row = i;
        }
    }
    return row;
}

double SweepProfile::calcSharp(double frequency) const {
    const double f = std::clamp(frequency, lowest_, highest_);
    return calcLevelOf(segments_[findRow(f)], f);
}

double SweepProfile::calcLevel(double frequency) const {
    const double x = std::log(frequency);
    for (const Passage& passage : passages_) {
        if (!(std::abs(x - passage.at) < passage.width)) continue;
        // Hermite's cubic.
        const double length = 2 * passage.width, u = (x - passage.at + passage.width) / length, v = 1 - u;
        return std::exp(v * v * (1 + 2 * u) * passage.level[0] + u * u * (1 + 2 * v) * passage.level[1] +
                        length * u * v * (v * passage.slope[0] - u * passage.slope[1]));
    }
    return calcSharp(frequency);
}

SweepProfile parseSweepProfile(std::string_view text, const std::string& file) {
    std::vector<ProfileSegment> segments;
    bool header_allowed = true;
    for (const TextRow& row : splitTextRows(text)) {
        const bool header = header_allowed && std::isalpha(static_cast<unsigned char>(row.text.front())) != 0;
        header_allowed = false;
        if (header) continue;
        if (row.cells.size() < 3 || row.cells.size() > 4)
            throw InputError({file, row.line, {}}, "\"" + std::string(row.text.substr(0, 60)) + "\" is no row",
                             "from and to in Hz and a level, such as 5,20,10mm, or two levels, at from and at to");
        ProfileSegment segment;
        segment.from = readFrequency(row.cells[0], {file, row.line, "from"});
        segment.to = readFrequency(row.cells[1], {file, row.line, "to"});
        if (!(segment.to > segment.from))
            throw InputError({file, row.line, "to"},
                             formatNumber(segment.to) + " Hz is not above " + formatNumber(segment.from) + " Hz",
                             "ascending frequencies");
        const ReadLevel start = readLevel(row.cells[2], {file, row.line, "level"});
        const ReadLevel end = row.cells.size() > 3 ? readLevel(row.cells[3], {file, row.line, "level"}) : start;
        if (end.quantity != start.quantity)
            throw InputError({file, row.line, "level"}, "is of two quantities", "one quantity in a row");
        segment.start_level = start.value;
        segment.end_level = end.value;
        segment.quantity = start.quantity;
        segments.push_back(segment);
    }
    try {
        return SweepProfile(std::move(segments));
    } catch (const InputError& error) {
        throw InputError({file, 0, error.location().key}, error.problem(), error.accepted());
    }
}

SweepProfile readSweepProfile(const std::string& file) {
    return parseSweepProfile(TextFile(file).view(), file);
}

std::unique_ptr<Signal> makeProfiledSweep(std::shared_ptr<const Signal> sweep, SweepProfile profile, Fade fade) {
    if (!(fade.start >= 0 && fade.end >= 0 && fade.start + fade.end <= sweep->duration()))
        throw InputError({{}, 0, "fade"}, "is longer than the sweep",
                         "together not longer than " + formatNumber(sweep->duration(), 6) + " s");
    return std::make_unique<ProfiledSweep>(std::move(sweep), std::move(profile), fade);
}

}  // namespace wems
