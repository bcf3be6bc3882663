#include "identify/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "identify/motion/guided_part_motion.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/motion/part_motion.hpp"
#include "models/common/error.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

namespace {

constexpr std::size_t minimum_samples = 8;
/// Deviations of a stamp below this part of the interval do not matter: at 1 m/s and 1 kHz they shift by 1 µm.
constexpr double harmless_deviation = 1e-3;

/// Half a unit of the last decimal in which all stamps are written; zero if they are not decimal fractions.
double findRounding(const std::vector<double>& time) {
    double unit = 1;
    for (int decimals = 0; decimals <= 9; ++decimals, unit /= 10) {
        const bool all = std::all_of(time.begin(), time.end(), [unit](double t) {
            const double scaled = t / unit;
            return std::abs(scaled - std::round(scaled)) < 1e-6 * std::max(1.0, std::abs(scaled) * 1e-6);
        });
        if (all) return unit / 2;
    }
    return 0;
}

}  // namespace

double interpolateCubic(const std::vector<double>& time, const std::vector<double>& values, std::size_t interval,
                        double t) {
    const std::size_t first = std::min(interval > 0 ? interval - 1 : 0, time.size() - 4);
    double sum = 0;
    for (std::size_t i = first; i < first + 4; ++i) {
        double weight = 1;
        for (std::size_t j = first; j < first + 4; ++j) {
            if (j != i) weight *= (t - time[j]) / (time[i] - time[j]);
        }
        sum += weight * values[i];
    }
    return sum;
}

Recording makeUniform(const Recording& recording, std::vector<std::string>& notes) {
    const std::size_t n = recording.sampleCount();
    if (n < minimum_samples)
        throw InputError({recording.file, 0, "time"}, "only " + std::to_string(n) + " samples",
                         "at least " + std::to_string(minimum_samples));
    const std::vector<double>& time = recording.time;
    const double h = (time.back() - time.front()) / static_cast<double>(n - 1);
    double deviation = 0, largest = 0, smallest = h;
    std::size_t gap = 0;
    for (std::size_t k = 0; k < n; ++k) {
        deviation = std::max(deviation, std::abs(time[k] - time.front() - static_cast<double>(k) * h));
        if (k == 0) continue;
        smallest = std::min(smallest, time[k] - time[k - 1]);
        if (time[k] - time[k - 1] > largest) {
            largest = time[k] - time[k - 1];
            gap = k;
        }
    }
    if (deviation < harmless_deviation * h) return recording;

    Recording uniform = recording;
    char text[240];
    // Two roundings (of the stamp, of the ends that define the interval) add up to two half units.
    const double rounding = deviation < h / 2 ? findRounding(time) : 0;
    if (rounding > 0 && deviation <= 2.02 * rounding && largest - smallest <= 2.02 * rounding) {
        for (std::size_t k = 0; k < n; ++k) uniform.time[k] = time.front() + static_cast<double>(k) * h;
        std::snprintf(text, sizeof text,
                      "time stamps are uniform within their %g s decimals; taken as uniform at %.6g Hz", 2 * rounding,
                      1 / h);
        notes.emplace_back(text);
        return uniform;
    }

    // The interval that most samples have, so that a gap does not thin out all the rest.
    std::vector<double> intervals(n - 1);
    for (std::size_t k = 1; k < n; ++k) intervals[k - 1] = time[k] - time[k - 1];
    std::nth_element(intervals.begin(), intervals.begin() + static_cast<long>(n / 2), intervals.end());
    const double target = intervals[n / 2];
    const auto count = static_cast<std::size_t>(std::floor((time.back() - time.front()) / target + 1e-6)) + 1;
    if (count > 20 * n)
        throw InputError({recording.file, recording.first_row + static_cast<long>(gap), "time"},
                         "the stamps leave gaps twenty times as long as what was recorded");
    std::vector<std::size_t> interval_of(count);
    uniform.time.resize(count);
    for (std::size_t k = 0, i = 0; k < count; ++k) {
        uniform.time[k] = std::min(time.front() + static_cast<double>(k) * target, time.back());
        while (i + 2 < n && time[i + 1] <= uniform.time[k]) ++i;
        interval_of[k] = i;
    }
    for (Channel& channel : uniform.channels) {
        std::vector<double> values(count);
        for (std::size_t k = 0; k < count; ++k)
            values[k] = interpolateCubic(time, channel.values, interval_of[k], uniform.time[k]);
        channel.values = std::move(values);
    }
    std::snprintf(text, sizeof text,
                  "time stamps are not uniform (%.4g to %.4g s); interpolated by cubics to %.6g Hz; the largest gap, "
                  "%.4g s at %.6g s, is bridged",
                  smallest, largest, 1 / target, largest, time[gap - 1]);
    notes.emplace_back(text);
    return uniform;
}

namespace {

/// Vector signal of load or base, missing axes zero; empty if no axis was recorded.
Eigen::Matrix3Xd collectVector(const Recording& recording, Part part) {
    Eigen::Matrix3Xd values;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part != part) continue;
        const Eigen::Index samples = channel.values.size();
        if (values.cols() == 0) values = Eigen::Matrix3Xd::Zero(3, samples);
        values.row(name->axis) = Eigen::Map<const Eigen::RowVectorXd>(channel.values.data(), samples);
    }
    return values;
}

PartEstimate estimateFixed(const Recording& recording, const MountModel& model, const PartEstimate* base,
                           RunMotion& run, const BodyMotion& rest, ContactEdges edges) {
    if (hasChannels(recording, Part::fixed)) {
        const bool guided = model.body.free != MobileBody().free;
        const bool all_six = determinesPart(recording, model, Part::fixed, rest);
        // A rigid table whose own sensors tell too little is the base that it stands on.
        const bool follows_base = base != nullptr && model.bracket.empty();
        if (all_six || (!guided && !follows_base)) return estimatePart(recording, model, Part::fixed, rest, edges);
        if (guided && (!follows_base || determinesGuided(recording, model, Part::fixed, rest)))
            return estimateGuided(recording, model, Part::fixed, rest, makeStandstill(rest, run.time.size()), edges);
    }
    if (!model.bracket.empty())
        throw InputError({recording.file, 0, "fixed"},
                         "the model has a bracket, so the fixed part moves, but no channel of it was recorded",
                         "fixed.<connection>.<x|y|z|ax|ay|az>, or a model without [bracket]");
    if (base != nullptr) {
        run.fixed_source = FixedSource::base;
        return *base;
    }
    run.fixed_source = FixedSource::still;
    PartEstimate estimate;
    estimate.motion = makeStandstill(rest, run.time.size());
    estimate.trusted_to = 0.25 / run.interval;
    estimate.notes.emplace_back("fixed part: no channels and no bracket in the model, so it stands still");
    return estimate;
}

}  // namespace

RunMotion estimateMotion(const Recording& recording, const MountModel& model, ContactEdges edges) {
    if (!hasChannels(recording, Part::mobile))
        throw InputError({recording.file, 0, "mobile"}, "no channel of the mobile part",
                         "mobile.<connection>.<x|y|z|vx|vy|vz|ax|ay|az>");
    RunMotion run;
    run.file = recording.file;
    const Recording uniform = makeUniform(recording, run.notes);
    run.time = uniform.time;
    run.interval = uniform.sampleInterval();
    run.load = collectVector(uniform, Part::load);
    run.base = collectVector(uniform, Part::base);

    const StaticEquilibrium equilibrium = findStaticEquilibrium(model);
    const BodyMotion fixed_rest = findFixedRest(model, equilibrium);
    std::optional<PartEstimate> base;
    if (run.base.cols() > 0) {
        base = estimateTranslation(uniform, run.base, fixed_rest);
        run.base_displacement = base->motion.p.colwise() - fixed_rest.p_GM;
    }
    PartEstimate fixed, mobile;
    const auto findFixed = [&] {
        fixed = estimateFixed(uniform, model, base ? &*base : nullptr, run, fixed_rest, edges);
    };
    if (model.body.free == MobileBody().free) {
        runParallel(
            {findFixed, [&] { mobile = estimatePart(uniform, model, Part::mobile, equilibrium.mobile, edges); }});
    } else {
        findFixed();
        mobile = estimateGuided(uniform, model, Part::mobile, equilibrium.mobile, fixed.motion, edges);
    }
    run.mobile_trusted_from = mobile.trusted_from;
    run.fixed_trusted_from = fixed.trusted_from;
    run.trusted_from = std::max(mobile.trusted_from, fixed.trusted_from);
    run.trusted_to = std::min(mobile.trusted_to, fixed.trusted_to);
    run.sufficient_rate = std::max(mobile.sufficient_rate, fixed.sufficient_rate);
    run.notes.insert(run.notes.end(), mobile.notes.begin(), mobile.notes.end());
    run.notes.insert(run.notes.end(), fixed.notes.begin(), fixed.notes.end());
    run.mobile = std::move(mobile.motion);
    run.fixed = std::move(fixed.motion);
    return run;
}

}  // namespace wems::identify
