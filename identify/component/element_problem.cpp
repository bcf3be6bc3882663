#include "identify/component/element_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/component/element_hypotheses.hpp"
#include "models/error.hpp"
#include "models/model_tolerance.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {
namespace {

/// A model of that element alone: all others without force.
MountModel isolate(const MountModel& model, std::size_t connection, std::size_t axis, double displacement) {
    MountModel element;
    element.tolerances = model.tolerances;
    element.body.mass = 1;
    element.connections = {model.connections[connection]};
    for (std::size_t a = 0; a < 3; ++a)
        if (a != axis) element.connections.front().axis[a] = AxisLaw{};
    // Each side has a stop, so that one may be found there.
    AxisLaw& law = element.connections.front().axis[axis];
    for (const Side side : {Side::positive, Side::negative})
        if (std::none_of(law.stops.begin(), law.stops.end(), [side](const Stop& stop) { return stop.side == side; }))
            law.stops.push_back({side, displacement, 0.0, 0.0});
    return element;
}

SensorLayout layOutCell(const std::string& place) {
    SensorLayout layout;
    layout.groups = {{Part::force, Derivative::displacement, {0}}};
    SensorChannel cell;
    cell.name = "force." + place;
    layout.channels = {cell};
    return layout;
}

/// A history as a channel that is late by `delay` records it.
void delayBy(double delay, const Eigen::VectorXd& time, Eigen::VectorXd& history) {
    if (delay == 0) return;
    const Eigen::VectorXd exact = history;
    Eigen::Index k = 0;
    for (Eigen::Index i = 0; i < history.size(); ++i) {
        const double at = std::clamp(time[i] - delay, time[0], time[time.size() - 1]);
        while (k + 2 < time.size() && time[k + 1] < at) ++k;
        while (k > 0 && time[k] > at) --k;
        const double part = (at - time[k]) / (time[k + 1] - time[k]);
        history[i] = (1 - part) * exact[k] + part * exact[k + 1];
    }
}

}  // namespace

Eigen::VectorXd calcForceError(const AxisLaw& law, double delay, const ComponentData& test) {
    Eigen::VectorXd force = calcForceAlong(law, test.time, test.q, test.velocity);
    delayBy(delay, test.time, force);
    Eigen::VectorXd error = test.force - force;
    error.array() -= error.mean();
    return error;
}

double calcElementError(const AxisLaw& law, double delay, const std::vector<ComponentData>& tests) {
    double left = 0, spread = 0;
    for (const ComponentData& test : tests) {
        left += calcForceError(law, delay, test).squaredNorm();
        spread += (test.force.array() - test.force.mean()).square().sum();
    }
    return spread > 0 ? std::sqrt(left / spread) : 0;
}

double calcForceNoise(const std::vector<ComponentData>& tests) {
    double noise = 0, spread = 0;
    for (const ComponentData& test : tests) {
        const Eigen::VectorXd& f = test.force;
        for (Eigen::Index k = 3; k < f.size(); ++k)
            noise += std::pow(f[k] - 3 * f[k - 1] + 3 * f[k - 2] - f[k - 3], 2) / 20;
        spread += (f.array() - f.mean()).square().sum();
    }
    return spread > 0 ? std::sqrt(noise / spread) : 0;
}

ElementProblem::ElementProblem(std::vector<ComponentData> tests, std::vector<ComponentData> judges,
                               const MountModel& model, std::size_t connection, int axis)
    : tests_(std::move(tests)),
      judges_(std::move(judges)),
      believed_{MountModel{}, SensorErrors(SensorLayout{})},
      axis_(axis),
      place_(model.connections[connection].name + "." + "xyz"[axis]) {
    Eigen::Index count = 0;
    scales_.lowest = std::numeric_limits<double>::infinity();
    for (const ComponentData& test : tests_) {
        starts_.push_back(count);
        count += test.count();
        positive_reach_ = std::max(positive_reach_, test.q.maxCoeff());
        negative_reach_ = std::max(negative_reach_, -test.q.minCoeff());
        scales_.velocity = std::max(scales_.velocity, test.velocity.cwiseAbs().maxCoeff());
        const double duration = test.time[test.count() - 1] - test.time[0];
        scales_.duration = std::max(scales_.duration, duration);
        // Reversals tell how slow and how fast the tests are.
        const auto reversals = findReversals(test.q, 0.05);
        scales_.lowest = std::min(scales_.lowest, 0.5 * static_cast<double>(reversals.size() + 1) / duration);
        std::size_t k = 1;
        for (; k < reversals.size(); ++k) {
            const double stroke = test.time[reversals[k].index] - test.time[reversals[k - 1].index];
            if (stroke > 0) {
                scales_.lowest = std::min(scales_.lowest, 0.5 / stroke);
                scales_.highest = std::max(scales_.highest, 0.5 / stroke);
            }
        }
    }
    scales_.highest = std::max(scales_.highest, scales_.lowest);
    scales_.displacement = std::max(positive_reach_, negative_reach_);
    if (!(scales_.displacement > 0) || !(scales_.velocity > 0))
        throw InputError({tests_.front().file, 0, {}}, "nothing moves, or the recording has no time",
                         "a displacement that varies, with its times");
    const SensorLayout layout = layOutCell(place_);
    believed_ = {isolate(model, connection, axis_, scales_.displacement), SensorErrors(layout)};
    // A law without a spring has no scale of its own: that of the tests serves, as far as reaches and steps go.
    TestState scaled = believed_;
    double& stiffness = scaled.model.connections.front().axis[axis_].stiffness;
    const bool springless = !(stiffness > 0);
    if (springless) stiffness = std::sqrt(calcSignalSquare() / static_cast<double>(count)) / scales_.displacement;
    for (Unknown& row : makeUnknownTable(scaled, SensorLayout{}, scales_, {})) {
        if (row.kind != UnknownKind::law || row.second != axis) continue;
        row.believed = row.get(believed_);
        if (springless && row.name == place_ + ".stiffness") row.deviation = 0;
        table_.push_back(std::move(row));
    }
    addDelayRow(model);
    hypotheses_ = listElementHypotheses(
        table_, believed_.model.connections.front().axis[axis_],
        {place_, scales_.lowest, scales_.highest, positive_reach_, negative_reach_, scales_.displacement});
}

void ElementProblem::addDelayRow(const MountModel& model) {
    Unknown row;
    row.kind = UnknownKind::channel_delay;
    row.name = "force." + place_ + ".delay";
    row.unit = "s";
    row.deviation = 0.5 * toleranceOf(model, ToleranceOf::sensor_delay);
    row.reach = 0.1 / scales_.highest;
    row.step = 1e-3 * row.reach;
    row.get = [](const TestState& state) { return state.sensors.delay[0]; };
    row.set = [](TestState& state, double value) { state.sensors.delay[0] = value; };
    table_.push_back(std::move(row));
}

AxisLaw ElementProblem::lawAt(const Eigen::VectorXd& values) const {
    TestState state = believed_;
    for (std::size_t i = 0; i < table_.size(); ++i) {
        const double value = values[i];
        if (value != table_[i].get(state)) table_[i].set(state, value);
    }
    AxisLaw law = state.model.connections.front().axis[axis_];
    law.stops.erase(
        std::remove_if(law.stops.begin(), law.stops.end(), [](const Stop& stop) { return stop.stiffness == 0; }),
        law.stops.end());
    if (law.relaxation && law.relaxation->stiffness_ratio == 0) law.relaxation.reset();
    if (law.friction && law.friction->force == 0) law.friction.reset();
    if (law.hysteresis && law.hysteresis->force == 0) law.hysteresis.reset();
    return law;
}

double ElementProblem::delayAt(const Eigen::VectorXd& values) const {
    return values[findUnknown(table_, "force." + place_ + ".delay")];
}

Eigen::VectorXd ElementProblem::calcResidual(const Eigen::VectorXd& values) const {
    const AxisLaw law = lawAt(values);
    const double delay = delayAt(values);
    Eigen::VectorXd residual(starts_.back() + tests_.back().count());
    for (std::size_t r = 0; r < tests_.size(); ++r)
        residual.segment(starts_[r], tests_[r].count()) = calcForceError(law, delay, tests_[r]);
    return residual;
}

double ElementProblem::calcSignalSquare() const {
    double sum = 0;
    for (const ComponentData& test : tests_) sum += (test.force.array() - test.force.mean()).square().sum();
    return sum;
}

GroupError ElementProblem::calcErrors(const Eigen::VectorXd& values) const {
    const AxisLaw law = lawAt(values);
    const double delay = delayAt(values);
    return {calcElementError(law, delay, tests_), calcElementError(law, delay, judges_)};
}

GroupError ElementProblem::calcNoiseFloor() const {
    return {calcForceNoise(tests_), calcForceNoise(judges_)};
}

double ElementProblem::calcJudgedDifference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    double square = 0, total = 0;
    for (const ComponentData& judge : judges_) {
        square +=
            (calcForceError(lawAt(a), delayAt(a), judge) - calcForceError(lawAt(b), delayAt(b), judge)).squaredNorm();
        total += (judge.force.array() - judge.force.mean()).square().sum();
    }
    return total > 0 ? square / total : 0;
}

}  // namespace wems::identify
