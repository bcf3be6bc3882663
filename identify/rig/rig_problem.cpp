#include "identify/rig/rig_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "identify/component/element_hypotheses.hpp"
#include "identify/forward/initial_state.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "identify/motion/uniform_time.hpp"
#include "models/error.hpp"
#include "models/model_tolerance.hpp"

namespace wems::identify {
namespace {

// Times the largest displacement: a response that grows beyond is as wrong as it can be.
constexpr double kUnbounded = 100;
// Of the largest displacement, within which dry friction sticks: a bristle, that costs a simulation no steps as a jump
// at rest does. It moves the response by about as much as it is long.
constexpr double kBristle = 0.01;

MountModel addDormantStops(MountModel model, std::size_t axis, double displacement) {
    for (Connection& connection : model.connections)
        for (const Side side : {Side::positive, Side::negative}) {
            auto& stops = connection.axis[axis].stops;
            if (std::none_of(stops.begin(), stops.end(), [side](const Stop& stop) { return stop.side == side; }))
                stops.push_back({side, displacement, 0.0, 0.0});
        }
    return model;
}

Eigen::VectorXd withoutMean(Eigen::VectorXd values) {
    values.array() -= values.mean();
    return values;
}

/// Where a connection does nothing along the axis there is nothing to be wrong.
bool acts(const Connection& connection, std::size_t axis) {
    const AxisLaw& law = connection.axis[axis];
    return law.stiffness > 0 || law.damping > 0 || law.friction || law.hysteresis || !law.stops.empty();
}

}  // namespace

std::optional<int> findRigAxis(const MountModel& model) {
    const auto& free = model.body.free;
    if (!model.bracket.empty() || std::count(free.begin(), free.end(), true) != 1) return std::nullopt;
    for (int axis = 0; axis < 3; ++axis)
        if (free.at(static_cast<std::size_t>(axis))) return axis;
    return std::nullopt;
}

RigProblem::RigProblem(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                       const MountModel& model)
    : axis_(findRigAxis(model).value()), identification_count_(identification.size()) {
    std::vector<Recording> all;
    for (const auto* group : {&identification, &validation})
        for (const Recording& recording : *group) {
            std::vector<std::string> notes;
            all.push_back(makeUniform(recording, notes));
        }
    motions_.resize(all.size());
    runParallel(all.size(), [&](std::size_t r) { motions_[r] = estimateMotion(all[r], model); });
    scales_.lowest = std::numeric_limits<double>::infinity();
    LoadedAxes loaded{};
    for (std::size_t r = 0; r < all.size(); ++r) {
        const RunMotion& motion = motions_[r];
        runs_.push_back({&motion, calcMeasuredRelative(all[r], motion, model)});
        const SweptFrequency band = findSweptFrequency(all[r]);
        if (!(band.lowest > 0))
            throw InputError({all[r].file, 0, {}}, "no motion stands out from the noise",
                             "a recording in which the device is driven or rings");
        scales_.lowest = std::min(scales_.lowest, band.lowest);
        scales_.highest = std::max(scales_.highest, band.highest);
        scales_.duration = std::max(scales_.duration, motion.time.back() - motion.time.front());
        const auto a = static_cast<Eigen::Index>(axis_);
        const Eigen::RowVectorXd velocity = motion.mobile.v.row(a) - motion.fixed.v.row(a);
        scales_.velocity = std::max(scales_.velocity, velocity.cwiseAbs().maxCoeff());
        positive_reach_ = std::max(positive_reach_, runs_.back().measured.row(a).maxCoeff());
        negative_reach_ = std::max(negative_reach_, -runs_.back().measured.row(a).minCoeff());
        if (motion.load.cols() > 0 && !motion.load.row(a).isZero(0.0)) loaded.at(static_cast<std::size_t>(a)) = true;
    }
    scales_.displacement = std::max(positive_reach_, negative_reach_);
    if (!(scales_.displacement > 0) || !(scales_.velocity > 0))
        throw InputError({all.front().file, 0, {}}, "nothing moves across the mount");
    believed_ = addDormantStops(model, static_cast<std::size_t>(axis_), scales_.displacement);
    const TestState state{believed_, SensorErrors(SensorLayout{})};
    for (Unknown& row : makeUnknownTable(state, SensorLayout{}, scales_, loaded)) {
        const bool own = row.kind == UnknownKind::law && row.second == axis_ &&
                         acts(model.connections[static_cast<std::size_t>(row.first)], static_cast<std::size_t>(axis_));
        if (own || row.name == "body.mass" || row.name == "load.gain") table_.push_back(std::move(row));
    }
    std::vector<std::string> sensors;
    for (const Recording& recording : all)
        for (const Channel& channel : recording.channels)
            if (channel.name.rfind("mobile.", 0) == 0 &&
                std::find(sensors.begin(), sensors.end(), channel.name) == sensors.end())
                sensors.push_back(channel.name);
    sensor_ = sensors.size() == 1 ? sensors.front() : "mobile";
    addSensorRows(model);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const RunMotion& motion = motions_[r];
        const auto a = static_cast<Eigen::Index>(axis_);
        measured_.emplace_back(passCompared(motion, runs_[r].measured.row(a)).row(0).transpose());
        RigRun drive;
        drive.interval = motion.interval;
        drive.count = measured_.back().size();
        if (motion.load.cols() > 0) drive.load = motion.load.row(a).transpose();
        if (motion.fixed_source != FixedSource::still) drive.acceleration = motion.fixed.a.row(a).transpose();
        const Drive whole = Drive::make(motion, model, makeGrid(motion, model));
        if (const auto start = findStartMotion(motion, model, whole)) {
            drive.start = runs_[r].measured(a, 0);
            drive.start_velocity = motion.mobile.v(a, 0) - motion.fixed.v(a, 0);
        }
        drives_.push_back(std::move(drive));
    }
    addHypotheses(model, loaded.at(static_cast<std::size_t>(axis_)));
}

void RigProblem::addSensorRows(const MountModel& model) {
    const auto add = [&](UnknownKind kind, const char* key, const char* unit, double tolerance, double reach,
                         double believed) {
        Unknown row;
        row.kind = kind;
        row.name = sensor_ + "." + key;
        row.unit = unit;
        row.deviation = 0.5 * tolerance;
        row.reach = reach;
        row.step = 1e-3 * reach;
        row.believed = believed;
        // Its value lies with the problem, not with a state of the model.
        row.get = [believed](const TestState&) { return believed; };
        row.set = [](TestState&, double) {};
        table_.push_back(std::move(row));
    };
    const Tolerances own = sensorTolerances(model, sensor_);
    add(UnknownKind::channel_gain, "gain", "-", toleranceOf(model, ToleranceOf::sensor_gain, own), 0.3, 1);
    add(UnknownKind::channel_delay, "delay", "s", toleranceOf(model, ToleranceOf::sensor_delay, own),
        0.1 / scales_.highest, 0);
}

void RigProblem::addHypotheses(const MountModel& model, bool loaded) {
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        if (!acts(model.connections[i], static_cast<std::size_t>(axis_))) continue;
        const std::string place = model.connections[i].name + "." + "xyz"[axis_];
        const auto own = listElementHypotheses(
            table_, believed_.connections[i].axis[static_cast<std::size_t>(axis_)],
            {place, scales_.lowest, scales_.highest, positive_reach_, negative_reach_, scales_.displacement});
        hypotheses_.insert(hypotheses_.end(), own.begin(), own.end());
    }
    const auto add = [&](const char* cause, const std::string& where, const std::string& name) {
        const int index = findUnknown(table_, name);
        if (index < 0) return;
        Hypothesis hypothesis;
        hypothesis.cause = cause;
        hypothesis.where = {where};
        hypothesis.directions = {{{index, table_[static_cast<std::size_t>(index)].reach}}};
        hypothesis.reported = {index};
        hypotheses_.push_back(std::move(hypothesis));
    };
    add("mass", "body", "body.mass");
    if (loaded) add("load", "load", "load.gain");
    add("sensor_gain", sensor_, sensor_ + ".gain");
    add("sensor_delay", sensor_, sensor_ + ".delay");
    std::map<std::string, int> places;
    for (const auto& hypothesis : hypotheses_) ++places[hypothesis.cause];
    for (auto& hypothesis : hypotheses_)
        hypothesis.log_prior = -std::log(static_cast<double>(places.size()) * places[hypothesis.cause]);
}

MountModel RigProblem::modelAt(const Eigen::VectorXd& values) const {
    TestState state{believed_, SensorErrors(SensorLayout{})};
    for (std::size_t i = 0; i < table_.size(); ++i) {
        const double value = values[static_cast<Eigen::Index>(i)];
        if (value != table_[i].get(state)) table_[i].set(state, value);
    }
    for (Connection& connection : state.model.connections) {
        AxisLaw& law = connection.axis[static_cast<std::size_t>(axis_)];
        law.stops.erase(
            std::remove_if(law.stops.begin(), law.stops.end(), [](const Stop& stop) { return stop.stiffness == 0; }),
            law.stops.end());
        if (law.relaxation && law.relaxation->stiffness_ratio == 0) law.relaxation.reset();
        if (law.friction && law.friction->force == 0) law.friction.reset();
        if (law.friction && !law.friction->presliding_stiffness)
            law.friction->presliding_stiffness = law.friction->force / (kBristle * scales_.displacement);
        if (law.hysteresis && law.hysteresis->force == 0) law.hysteresis.reset();
    }
    return state.model;
}

Eigen::VectorXd RigProblem::respond(std::size_t run, const MountModel& model) const {
    RigRun drive = drives_[run];
    if (model.load && !model.load->gain_over_frequency.empty()) drive.load *= model.load->gain_over_frequency[0].second;
    const double most = kUnbounded * scales_.displacement;
    const Eigen::VectorXd q = simulateRig(model, axis_, drive).cwiseMax(-most).cwiseMin(most);
    return passCompared(motions_[run], q.transpose()).row(0).transpose();
}

Eigen::VectorXd RigProblem::calcRunResidual(std::size_t run, const MountModel& model, double gain, double delay) const {
    Eigen::VectorXd simulated = respond(run, model);
    if (delay != 0) {
        const double shift = delay / motions_[run].interval;
        const Eigen::VectorXd exact = simulated;
        const Eigen::Index last = exact.size() - 1;
        for (Eigen::Index k = 0; k <= last; ++k) {
            const double at = std::clamp(static_cast<double>(k) - shift, 0.0, static_cast<double>(last));
            const auto below = std::min(static_cast<Eigen::Index>(at), last - 1);
            const double part = at - static_cast<double>(below);
            simulated[k] = (1 - part) * exact[below] + part * exact[below + 1];
        }
    }
    return withoutMean(gain * simulated - measured_[run]);
}

std::size_t RigProblem::firstJudge() const {
    return identification_count_ < runs_.size() ? identification_count_ : 0;
}

Eigen::VectorXd RigProblem::calcResidual(const Eigen::VectorXd& values) const {
    const MountModel model = modelAt(values);
    const double gain = values[findUnknown(table_, sensor_ + ".gain")],
                 delay = values[findUnknown(table_, sensor_ + ".delay")];
    std::vector<Eigen::VectorXd> parts;
    Eigen::Index count = 0;
    for (std::size_t r = 0; r < identification_count_; ++r) {
        parts.push_back(calcRunResidual(r, model, gain, delay));
        count += parts.back().size();
    }
    Eigen::VectorXd residual(count);
    Eigen::Index first = 0;
    for (const Eigen::VectorXd& part : parts) {
        residual.segment(first, part.size()) = part;
        first += part.size();
    }
    return residual;
}

double RigProblem::calcSignalSquare() const {
    double sum = 0;
    for (std::size_t r = 0; r < identification_count_; ++r) sum += measured_[r].squaredNorm();
    return sum;
}

GroupError RigProblem::calcErrors(const Eigen::VectorXd& values) const {
    const MountModel model = modelAt(values);
    const auto errorOf = [&](std::size_t begin, std::size_t end) {
        double difference = 0, signal = 0;
        for (std::size_t r = begin; r < end; ++r) {
            difference += (respond(r, model) - measured_[r]).squaredNorm();
            signal += measured_[r].squaredNorm();
        }
        return signal > 0 ? std::sqrt(difference / signal) : 0.0;
    };
    const double own = errorOf(0, identification_count_);
    return {own, firstJudge() == 0 ? own : errorOf(firstJudge(), runs_.size())};
}

GroupError RigProblem::calcNoiseFloor() const {
    // Third differences of a displacement that is sampled finely hold little but white noise (variance 20 σ²).
    const auto floorOf = [&](std::size_t begin, std::size_t end) {
        double noise = 0, signal = 0;
        for (std::size_t r = begin; r < end; ++r) {
            const Eigen::VectorXd& q = measured_[r];
            const double scatter = (q.tail(q.size() - 3) - 3 * q.segment(2, q.size() - 3) +
                                    3 * q.segment(1, q.size() - 3) - q.head(q.size() - 3))
                                       .squaredNorm() /
                                   20;
            const double known = calcNoiseVariance(runs_[r], believed_) * static_cast<double>(q.size());
            noise += known > 0 ? std::min(known, scatter) : scatter;
            signal += q.squaredNorm();
        }
        return signal > 0 ? std::sqrt(noise / signal) : 0;
    };
    const double own = floorOf(0, identification_count_);
    return {own, firstJudge() == 0 ? own : floorOf(firstJudge(), runs_.size())};
}

double RigProblem::calcJudgedDifference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    const MountModel first = modelAt(a), second = modelAt(b);
    const std::size_t end = firstJudge() == 0 ? identification_count_ : runs_.size();
    double square = 0, signal = 0;
    for (std::size_t r = firstJudge(); r < end; ++r) {
        square += (calcRunResidual(r, first, 1, 0) - calcRunResidual(r, second, 1, 0)).squaredNorm();
        signal += measured_[r].squaredNorm();
    }
    return signal > 0 ? square / signal : 0;
}

}  // namespace wems::identify
