#include "identify/plan/test_setup.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "identify/fit/law_history.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

namespace {

/// Each axis that is driven, as `x` and its level.
template <typename Function>
std::vector<std::string> listLevels(const Eigen::Vector3d& level, const Function& format) {
    std::vector<std::string> words;
    for (int axis = 0; axis < 3; ++axis)
        if (level[axis] != 0) words.push_back(format(std::string(kAxes[axis]), formatNumber(level[axis])));
    return words;
}

std::string quoteForShell(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string("_-./+:,=@%").find(c) < 20;
    });
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

}  // namespace

double PlannedRun::duration() const {
    return 60 * std::abs(std::log2(to / from)) / octaves_per_minute;
}

std::string describe(const PlannedRun& candidate) {
    const bool load = candidate.excitation == Excitation::load;
    const std::string unit = load ? " N" : " m/s^2";
    const auto levels = listLevels(candidate.level, [&](const std::string& axis, const std::string& value) {
        std::string word = axis;
        return word.append(" ").append(value).append(unit);
    });
    const SensorKinds& sensors = candidate.sensors;
    return std::string(candidate.to > candidate.from ? "sweep up" : "sweep down") + " from " +
           formatNumber(candidate.from) + " to " + formatNumber(candidate.to) + " Hz at " +
           formatNumber(candidate.octaves_per_minute) + " octaves per minute (" +
           formatNumber(candidate.duration(), 3) + " s), " + (load ? "force " : "base acceleration ") +
           joinWords(levels, " and ") + ", recorded as " +
           (sensors.displacement ? sensors.acceleration ? "displacements and accelerations" : "displacements"
                                 : "accelerations") +
           " at " + formatNumber(candidate.sample_rate) + " Hz";
}

std::string formatCommand(const PlannedRun& candidate, const std::string& model_file) {
    const auto levels = listLevels(
        candidate.level, [](std::string axis, const std::string& value) { return axis.append("=").append(value); });
    return "simulate " + quoteForShell(model_file) + " --sweep " + formatNumber(candidate.from) + ":" +
           formatNumber(candidate.to) + " --rate " + formatNumber(candidate.octaves_per_minute) +
           (candidate.excitation == Excitation::load ? " --force " : " --base-acceleration ") + joinWords(levels, ",") +
           " --sample-rate " + formatNumber(candidate.sample_rate) + " -o next.csv";
}

double roundDown(double value, int digits) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - digits + 1);
    // What is such a number already may lie below it by rounding; dividing by a whole power keeps decimals short.
    const double whole = std::floor(value / unit * (1 + 1e-12));
    return unit >= 1 ? whole * unit : whole / std::round(1 / unit);
}

namespace {

constexpr int kLimitDigits = 3;                // of levels and limits
constexpr double kBeyondClearance = 1.25;      // stroke over clearance that shows a stop well
constexpr std::size_t kMostSamples = 300'000;  // of a candidate: a fit of so many takes some seconds

/// To `digits` significant digits, so that 5.013 Hz, read from zero crossings, is 5 Hz again.
double roundTo(double value, int digits) {
    return std::strtod(formatNumber(value, digits).c_str(), nullptr);
}

/// What a logarithmic sweep extrapolates to, unless that is far from what was detected: another kind of sweep.
double takeIfNear(double value, double detected) {
    constexpr double near = 0.3;  // a first period of 5 Hz at 90 octaves per minute
    return std::abs(value / detected - 1) < near ? value : detected;
}

void chooseBand(const std::vector<Recording>& recordings, const AskedSetup& asked, TestSetup& setup) {
    bool swept = false;
    for (const Recording& recording : recordings) {
        const SweptFrequency frequency = findSweptFrequency(recording);
        const Eigen::Index count = frequency.hertz.size();
        if (!frequency.is_sine || !(frequency.highest > 1.05 * frequency.lowest) || count < 8) continue;
        const Eigen::Index early = count / 4, late = 3 * count / 4;
        const double octaves = std::log2(frequency.hertz[late] / frequency.hertz[early]);
        const double duration = recording.time[late] - recording.time[early];
        const double rate = 60 * std::abs(octaves) / duration;
        // Zero crossings tell the frequency from the first whole period on; a logarithmic sweep began before.
        const double start = frequency.hertz[early] * std::exp2(-0.5 * octaves),
                     end = frequency.hertz[late] * std::exp2(0.5 * octaves);
        const double lowest = roundTo(takeIfNear(std::min(start, end), frequency.lowest), 2);
        const double highest = roundTo(takeIfNear(std::max(start, end), frequency.highest), 2);
        setup.from = swept ? std::min(setup.from, lowest) : lowest;
        setup.to = swept ? std::max(setup.to, highest) : highest;
        if (std::isfinite(rate) && rate > 0)
            setup.octaves_per_minute = swept ? std::min(setup.octaves_per_minute, roundTo(rate, 2)) : roundTo(rate, 2);
        swept = true;
    }
    if (asked.band) std::tie(setup.from, setup.to) = *asked.band;
    if (asked.octaves_per_minute) setup.octaves_per_minute = *asked.octaves_per_minute;
    if (asked.band && asked.octaves_per_minute) return;
    setup.notes.push_back(
        std::string(swept ? "band and rate, where not given, as recorded: " : "nothing recorded sweeps; taken: ") +
        formatNumber(setup.from) + " to " + formatNumber(setup.to) + " Hz, " + formatNumber(setup.octaves_per_minute) +
        " octaves per minute");
}

/// Root mean square of the finite ones; NaN without.
class MeanNoise {
public:
    void add(double noise) {
        if (!std::isfinite(noise)) return;
        sum_ += noise * noise;
        ++count_;
    }
    double value() const { return count_ > 0 ? std::sqrt(sum_ / count_) : NAN; }

private:
    double sum_ = 0;
    int count_ = 0;
};

/// Of the channels of one kind from their own fast part, for parts without redundant channels; 0 without channels.
double estimateFromChannels(const std::vector<Recording>& recordings, Part part, Derivative kind) {
    std::vector<double> levels;
    for (const Recording& recording : recordings)
        for (const Channel& channel : recording.channels) {
            const auto name = parseChannelName(channel.name);
            if (!name || name->part != part || name->derivative != kind) continue;
            const Eigen::Map<const Eigen::VectorXd> values(channel.values.data(), channel.values.size());
            const double noise = estimateNoiseFromSignal(values);
            if (std::isfinite(noise)) levels.push_back(noise);
        }
    return levels.empty() ? 0 : median(std::move(levels));
}

void findSensors(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings, Part part,
                 PartMotion RunMotion::*which, SensorKinds& kinds, ChannelNoise& noise, double& scatter) {
    MeanNoise displacement, acceleration;
    for (const RunMotion& run : runs) {
        const PartMotion& motion = run.*which;
        if (motion.displacement_measured) displacement.add(motion.displacement_noise);
        if (motion.acceleration_measured) acceleration.add(motion.acceleration_noise);
        kinds.displacement = kinds.displacement || motion.displacement_measured;
        kinds.acceleration = kinds.acceleration || motion.acceleration_measured;
        scatter = std::max(
            {scatter, motion.displacement_calibration.gain_scatter, motion.acceleration_calibration.gain_scatter});
    }
    const auto choose = [&](double rigid, Derivative kind) {
        return std::isfinite(rigid) ? rigid : estimateFromChannels(recordings, part, kind);
    };
    if (kinds.displacement) noise.displacement = choose(displacement.value(), Derivative::displacement);
    if (kinds.acceleration) noise.acceleration = choose(acceleration.value(), Derivative::acceleration);
}

void findChannels(const std::vector<Recording>& recordings, const MountModel& model, TestSetup& setup) {
    if (!model.places.empty()) {
        setup.notes.emplace_back("the further run is taken to have its sensors at every connection");
        return;
    }
    std::set<std::string> names;
    for (const Recording& recording : recordings)
        for (const Channel& channel : recording.channels) names.insert(channel.name);
    setup.channels.assign(names.begin(), names.end());
}

/// Largest levels of a group of runs.
struct Reached {
    double force = 0, acceleration = 0, displacement = 0, stroke = 0;
};

double findLargest(const Eigen::Matrix3Xd& rows) {
    return rows.cols() > 0 ? rows.colwise().norm().maxCoeff() : 0;
}

Reached findReached(const std::vector<RunMotion>& runs, const MountModel& model) {
    Reached reached;
    for (const RunMotion& run : runs) {
        reached.force = std::max(reached.force, findLargest(run.load));
        if (run.base.cols() > 0) {
            reached.acceleration = std::max(reached.acceleration, findLargest(run.base));
            reached.displacement = std::max(reached.displacement, findLargest(run.base_displacement));
        } else if (model.bracket.empty() && run.fixed_source == FixedSource::channels) {
            // The fixed part stands on the table.
            reached.acceleration = std::max(reached.acceleration, findLargest(run.fixed.a));
            reached.displacement = std::max(reached.displacement,
                                            findLargest(run.fixed.p.colwise() - Eigen::Vector3d(run.fixed.p.col(0))));
        }
        reached.stroke = std::max(reached.stroke, calcRelativeHistory(run, model).q.cwiseAbs().maxCoeff());
    }
    return reached;
}

bool baseActs(const MountModel& model) {
    return model.bracket.empty() ||
           std::any_of(model.bracket.begin(), model.bracket.end(),
                       [](const BracketMode& mode) { return !mode.base_participation.isZero(0); });
}

double findLargestClearance(const MountModel& model) {
    double largest = 0;
    for (const Connection& connection : model.connections)
        for (const AxisLaw& law : connection.axis)
            for (const Stop& stop : law.stops)
                if (std::isfinite(stop.clearance)) largest = std::max(largest, stop.clearance);
    return largest;
}

/// The limit asked for, or what the recordings reached, with a note.
double choose(const std::optional<double>& asked, double reached, const std::string& what, const std::string& unit,
              TestSetup& setup) {
    if (asked) return *asked;
    if (!(reached > 0)) return 0;
    const double limit = roundTo(reached, kLimitDigits);
    setup.notes.push_back("limit of the " + what + ", where none was given: " + formatNumber(limit, kLimitDigits) +
                          " " + unit + ", the largest recorded");
    return limit;
}

void findLimits(const std::vector<RunMotion>& runs, const MountModel& model, const AskedSetup& asked,
                TestSetup& setup) {
    const Reached reached = findReached(runs, model);
    PlanLimits& limits = setup.limits;
    if (asked.force && !loadActs(model))
        throw InputError({"", 0, "--max-force"}, "the model has nothing that a force could act on",
                         "a [bracket], or a [load] on the mobile part");
    if ((asked.acceleration || asked.displacement) && !baseActs(model))
        throw InputError({"", 0, asked.acceleration ? "--max-acceleration" : "--max-displacement"},
                         "the bracket's modes have no participation in a motion of the base",
                         "a modes file with base.ux, base.uy, base.uz");
    if (loadActs(model)) limits.force = choose(asked.force, reached.force, "force", "N", setup);
    if (baseActs(model)) {
        limits.acceleration = choose(asked.acceleration, reached.acceleration, "base's acceleration", "m/s^2", setup);
        if (limits.acceleration > 0 || asked.displacement)
            limits.displacement = choose(asked.displacement, reached.displacement, "base's displacement", "m", setup);
    }
    if (asked.displacement && !(limits.acceleration > 0))
        throw InputError({"", 0, "--max-displacement"}, "the recordings tell no acceleration of the base",
                         "--max-acceleration beside it");
    if (!(limits.force > 0) && !(limits.acceleration > 0))
        throw InputError({}, "the recordings have neither a load that acts on the model nor a motion of the base",
                         "--max-force or --max-acceleration");
    limits.stroke = asked.stroke.value_or(std::max(reached.stroke, kBeyondClearance * findLargestClearance(model)));
    if (!asked.stroke)
        setup.notes.push_back(
            "limit of the stroke, where none was given: " + formatNumber(limits.stroke, kLimitDigits) +
            " m, the largest recorded or a quarter beyond the largest clearance");
}

/// As recorded, unless a run would become too long for its fit; slower sampling then has less noise left to average.
void findSampleRate(const std::vector<RunMotion>& runs, TestSetup& setup) {
    double interval = runs.front().interval;
    for (const RunMotion& run : runs) interval = std::min(interval, run.interval);
    setup.sample_rate = roundTo(1 / interval, 4);
    const double duration = 60 * std::log2(setup.to / setup.from) / setup.octaves_per_minute;
    if (duration * setup.sample_rate <= kMostSamples) return;
    const double rate = roundDown(kMostSamples / duration, 2);
    const double factor = std::sqrt(rate / setup.sample_rate);
    for (ChannelNoise* noise : {&setup.mobile_noise, &setup.fixed_noise}) {
        noise->displacement *= factor;
        noise->acceleration *= factor;
    }
    setup.base_noise *= factor;
    setup.notes.push_back("the further run is rehearsed at " + formatNumber(rate) + " Hz, not at " +
                          formatNumber(setup.sample_rate) + " Hz, with as much less noise");
    setup.sample_rate = rate;
}

}  // namespace

TestSetup findTestSetup(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings,
                        const MountModel& model, const AskedSetup& asked) {
    TestSetup setup;
    chooseBand(recordings, asked, setup);
    findSensors(runs, recordings, Part::mobile, &RunMotion::mobile, setup.mobile, setup.mobile_noise,
                setup.gain_scatter);
    findSensors(runs, recordings, Part::fixed, &RunMotion::fixed, setup.fixed, setup.fixed_noise, setup.gain_scatter);
    if (!setup.mobile.displacement && !setup.mobile.acceleration)
        throw InputError({recordings.front().file, 0, "mobile"}, "has velocities alone",
                         "displacements or accelerations, which a further run can be planned with");
    setup.has_base = std::any_of(runs.begin(), runs.end(), [](const RunMotion& run) { return run.base.cols() > 0; });
    if (setup.has_base) setup.base_noise = estimateFromChannels(recordings, Part::base, Derivative::acceleration);
    findChannels(recordings, model, setup);
    findLimits(runs, model, asked, setup);
    findSampleRate(runs, setup);
    return setup;
}

}  // namespace wems::identify
