#include "identify/component/element_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/model_tolerance.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {

namespace {

// Parts of the largest displacement at which a stop or a yield displacement is sought: the law is not linear in them.
constexpr double kMissingStops[] = {0.35, 0.55, 0.75, 0.9};
constexpr double kYields[] = {0.03, 0.1, 0.3, 0.8};
constexpr double kFarClearances[] = {0.6, 1.4};  // of the believed one
constexpr double kCommonReach = 0.5;             // of a number that is sought by a start

class Lister {
public:
    Lister(const UnknownTable& table, const AxisLaw& believed, const ElementReach& reach)
        : table_(table), believed_(believed), reach_(reach) {}

    std::vector<Hypothesis> make() {
        addNumber("elastomer_stiffness", "stiffness");
        addNumber("viscous_damping", "damping");
        addNumber("structural_damping", "loss_factor");
        addFriction();
        addNumber("asymmetric_stiffness", "quadratic");
        addNumber("cubic_stiffness", "cubic");
        addNumber("stiffness_drift", "drift");
        addRelaxation();
        addHysteresis();
        for (const Stop& stop : believed_.stops) addStop(stop);
        addBothSides();
        const std::string channel = "force." + reach_.place;
        if (const int delay = row(channel + ".delay"); delay >= 0) setFree(add("sensor_delay", {channel}), delay);
        shareOdds();
        return std::move(list_);
    }

private:
    int row(const std::string& name) const { return findUnknown(table_, name); }
    int own(const std::string& key) const { return row(reach_.place + "." + key); }
    const Unknown& at(int index) const { return table_[index]; }

    Hypothesis& add(const std::string& cause, std::vector<std::string> where) {
        Hypothesis hypothesis;
        hypothesis.cause = cause;
        hypothesis.where = std::move(where);
        list_.push_back(std::move(hypothesis));
        return list_.back();
    }

    void setFree(Hypothesis& hypothesis, int index, double reach = 0) const {
        hypothesis.directions.push_back({{index, reach > 0 ? reach : at(index).reach}});
        hypothesis.reported.push_back(index);
    }

    void addNumber(const std::string& cause, const std::string& key) {
        const int index = own(key);
        if (index < 0) return;
        setFree(add(cause, {reach_.place}), index);
    }

    void addFriction() {
        const int force = own("friction_force"), transition = own("transition_velocity");
        if (force < 0) return;
        Hypothesis& hypothesis = add("friction", {reach_.place});
        setFree(hypothesis, force);
        if (believed_.friction && believed_.friction->presliding_stiffness) return;  // such a law has none
        setFree(hypothesis, transition, kCommonReach * at(transition).believed);
    }

    void addRelaxation() {
        if (believed_.relaxation) return;
        const int ratio = own("stiffness_ratio"), constant = own("time_constant");
        if (ratio < 0 || constant < 0 || !(believed_.stiffness > 0)) return;
        // Half a decade apart, from the fastest stroke to the slowest.
        const double first = std::log(reach_.lowest / 2), last = std::log(reach_.highest * 2);
        const int count = 1 + static_cast<int>(std::ceil((last - first) / std::log(5.0)));
        for (int i = 0; i < count; ++i) {
            const double f = std::exp(first + (last - first) * (i + 0.5) / count), tau = 1 / (kTwoPi * f);
            Hypothesis& hypothesis = add("relaxation", {reach_.place});
            setFree(hypothesis, ratio);
            setFree(hypothesis, constant, kCommonReach * tau);
            hypothesis.start = {{constant, tau}};
        }
    }

    void addHysteresis() {
        if (believed_.hysteresis || own("hysteresis_force") < 0) return;
        for (const double part : kYields) {
            const double yield = part * reach_.displacement;
            Hypothesis& hypothesis = add("hysteresis", {reach_.place});
            setFree(hypothesis, own("hysteresis_force"));
            setFree(hypothesis, own("yield_displacement"), kCommonReach * yield);
            hypothesis.start = {{own("yield_displacement"), yield}};
        }
    }

    void addStop(const Stop& stop) {
        const bool positive = stop.side == Side::positive;
        const std::string key = positive ? "+" : "-", place = reach_.place + "." + key;
        const int clearance = own(key + ".clearance"), stiffness = own(key + ".stiffness");
        const double reached = positive ? reach_.positive : reach_.negative;
        if (clearance < 0 || stiffness < 0) return;
        if (stop.stiffness > 0) {
            setFree(add("stop_stiffness", {place}), stiffness);
            setFree(add("clearance", {place}), clearance);
            for (const double far : kFarClearances) {
                const double c = far * stop.clearance;
                if (std::min(c, stop.clearance) > reached) continue;
                Hypothesis& hypothesis = add("clearance", {place});
                setFree(hypothesis, clearance, kCommonReach * c);
                hypothesis.start = {{clearance, c}};
            }
            return;
        }
        if (!(reached > 0.05 * reach_.displacement)) return;
        for (const double part : kMissingStops) {
            Hypothesis& hypothesis = add("clearance", {place});
            setFree(hypothesis, clearance, kCommonReach * part * reached);
            setFree(hypothesis, stiffness);
            hypothesis.start = {{clearance, part * reached}, {stiffness, 0.5 * at(stiffness).reach}};
        }
    }

    void addBothSides() {
        std::vector<const Stop*> real;
        for (const Stop& stop : believed_.stops)
            if (stop.stiffness > 0) real.push_back(&stop);
        if (real.empty()) return;
        if (const int index = own("dissipation"); index >= 0) setFree(add("stop_dissipation", {reach_.place}), index);
        if (real.size() != 2 || own("offset") < 0) return;
        setFree(add("preload", {reach_.place}), own("offset"));
        for (const char* what : {"clearance", "stiffness"}) {
            Hypothesis& hypothesis = add(what == std::string("clearance") ? what : "stop_stiffness",
                                         {reach_.place + ".+", reach_.place + ".-"});
            Direction direction;
            for (const char* side : {"+", "-"}) {
                const int index = own(std::string(side) + "." + what);
                direction.emplace_back(index, kCommonReach * at(index).believed);
                hypothesis.reported.push_back(index);
            }
            hypothesis.directions = {direction};
        }
    }

    /// Each cause has the same odds, shared by its places and starts, as for whole mounts.
    void shareOdds() {
        std::map<std::string, int> places;
        for (const auto& hypothesis : list_) ++places[hypothesis.cause];
        for (auto& hypothesis : list_)
            hypothesis.log_prior = -std::log(static_cast<double>(places.size()) * places[hypothesis.cause]);
    }

    const UnknownTable& table_;
    const AxisLaw& believed_;
    const ElementReach& reach_;
    std::vector<Hypothesis> list_;
};

}  // namespace

std::vector<Hypothesis> listElementHypotheses(const UnknownTable& table, const AxisLaw& believed,
                                              const ElementReach& reach) {
    return Lister(table, believed, reach).make();
}

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
