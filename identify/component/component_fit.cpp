#include "identify/component/component_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/component/block_regression.hpp"
#include "identify/component/component_data.hpp"
#include "models/common/error.hpp"
#include "models/law_equality.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {

namespace {

/// All recordings stacked, each of its own length.
struct Stack {
    ComponentData all;
    std::vector<Eigen::Index> run_starts;
};

Stack stackRecordings(const std::vector<Recording>& recordings, ComponentOptions options, const MountModel& model) {
    if (recordings.empty()) throw InputError({}, "no recording to fit");
    Stack stack;
    std::vector<ComponentData> parts;
    Eigen::Index count = 0;
    for (const auto& recording : recordings) {
        options = completeOptions(recording, model, options);
        parts.push_back(extractComponent(recording, options));
        options.connection = parts.front().connection;  // the following ones must have the same
        options.axis = parts.front().axis;
        stack.run_starts.push_back(count);
        count += parts.back().count();
    }
    stack.all = parts.front();
    for (auto* array : {&stack.all.time, &stack.all.q, &stack.all.velocity, &stack.all.force}) array->resize(count);
    for (std::size_t r = 0; r < parts.size(); ++r) {
        const Eigen::Index start = stack.run_starts[r], n = parts[r].count();
        stack.all.time.segment(start, n) = parts[r].time;
        stack.all.q.segment(start, n) = parts[r].q;
        stack.all.velocity.segment(start, n) = parts[r].velocity;
        stack.all.force.segment(start, n) = parts[r].force;
        stack.all.has_velocity = stack.all.has_velocity && parts[r].has_velocity;
        stack.all.qualitative = stack.all.qualitative || parts[r].qualitative;
    }
    return stack;
}

/// Direction of travel, of each recording on its own.
Eigen::VectorXd stackDirection(const Stack& stack) {
    Eigen::VectorXd direction(stack.all.count());
    for (std::size_t r = 0; r < stack.run_starts.size(); ++r) {
        const Eigen::Index begin = stack.run_starts[r];
        const Eigen::Index end = r + 1 < stack.run_starts.size() ? stack.run_starts[r + 1] : stack.all.count();
        direction.segment(begin, end - begin) = calcDirection(stack.all.q.segment(begin, end - begin), 0.05);
    }
    return direction;
}

/// A linear column of the problem: its name in results, its place in the law.
struct Column {
    std::string name, unit;
    Eigen::VectorXd values;
    double AxisLaw::*member;  ///< nullptr: handled apart
};

std::vector<Column> makeColumns(const Stack& stack, const AxisLaw& law) {
    const auto& data = stack.all;
    std::vector<Column> columns;
    columns.push_back({"stiffness", "N/m", data.q, &AxisLaw::stiffness});
    if (data.has_velocity) columns.push_back({"damping", "N s/m", data.velocity, &AxisLaw::damping});
    if (law.quadratic != 0)
        columns.push_back({"quadratic", "N/m^2", data.q.array().square().matrix(), &AxisLaw::quadratic});
    if (law.cubic != 0) columns.push_back({"cubic", "N/m^3", data.q.array().cube().matrix(), &AxisLaw::cubic});
    if (law.friction) {
        columns.push_back({"friction_force", "N",
                           data.has_velocity
                               ? Eigen::VectorXd((data.velocity / law.friction->transition_velocity).array().tanh())
                               : stackDirection(stack),
                           nullptr});
    }
    columns.push_back({"force_offset", "N", Eigen::VectorXd::Ones(data.count()), nullptr});
    return columns;
}

std::string stopName(const std::vector<Stop>& stops, std::size_t index) {
    std::size_t before = 0;
    for (std::size_t i = 0; i < index; ++i) before += stops[i].side == stops[index].side ? 1U : 0U;
    const std::string side = stops[index].side == Side::positive ? "+" : "-";
    return before == 0 ? side : side + std::to_string(before + 1);
}

/// Takes out of a law what a component test does not fit: the fitted stiffness and dashpot hold its effect, and with it
/// the fitted model would have it twice. Clearances then count from rest. Returns a note; empty if there was nothing.
std::string keepFittedTerms(AxisLaw& law) {
    constexpr double least = 1e-9;  // m, since a clearance is positive
    std::vector<std::string> dropped;
    const auto drop = [&](const char* name, double& value) {
        if (value != 0) dropped.emplace_back(name);
        value = 0;
    };
    for (Stop& stop : law.stops) {
        const double shift = stop.side == Side::positive ? -law.offset : law.offset;
        stop.clearance = std::max(least, stop.clearance + shift);
    }
    drop("offset", law.offset);
    drop("loss_factor", law.loss_factor);
    drop("drift", law.drift);
    if (law.relaxation) dropped.emplace_back("relaxation");
    law.relaxation.reset();
    if (!law.spectrum.empty()) dropped.emplace_back("spectrum");
    law.spectrum.clear();
    if (law.friction && law.friction->presliding_stiffness) {
        dropped.emplace_back("friction.presliding_stiffness");
        law.friction->presliding_stiffness.reset();
    }
    if (law.hysteresis) dropped.emplace_back("hysteresis");
    law.hysteresis.reset();
    double dissipation = 0;
    for (Stop& stop : law.stops) dissipation = std::max(dissipation, std::exchange(stop.dissipation, 0.0));
    drop("stops.dissipation", dissipation);
    std::string note;
    for (const auto& name : dropped) note += (note.empty() ? "" : ", ") + name;
    return note.empty() ? note
                        : "the model's " + note +
                              ": not what a component test tells; left out of the fitted model, whose other values "
                              "hold the effect (clearances count from rest)";
}

/// What the fit has no column for and takes as the model has it: curve, branches, sliders.
AxisLaw pickKnown(const AxisLaw& law) {
    AxisLaw known;
    known.curve = law.curve;
    known.branches = law.branches;
    known.sliders = law.sliders;
    return known;
}

/// Force of a law, each recording on its own.
Eigen::VectorXd stackForce(const Stack& stack, const AxisLaw& law) {
    const ComponentData& all = stack.all;
    Eigen::VectorXd force(all.count());
    for (std::size_t r = 0; r < stack.run_starts.size(); ++r) {
        const Eigen::Index begin = stack.run_starts[r];
        const Eigen::Index end = r + 1 < stack.run_starts.size() ? stack.run_starts[r + 1] : all.count();
        const auto cut = [&](const Eigen::VectorXd& values) { return values.segment(begin, end - begin).eval(); };
        force.segment(begin, end - begin) = calcForceAlong(law, cut(all.time), cut(all.q), cut(all.velocity));
    }
    return force;
}

/// The data never go where the parameter acts: what to do about it.
std::string adviseOn(const std::string& name) {
    if (name.find("clearance") != std::string::npos) return "a test that travels beyond this stop";
    if (name.find("damping") != std::string::npos) return "a faster test";
    return "a test with a larger travel, in both directions";
}

/// Stop whose force is least distinguishable from none, or −1 if all are clear. A hinge that is free to move always
/// finds some noise to bend along, hence four standard errors and a thousandth of the force instead of the usual two.
std::ptrdiff_t findUnreachedStop(const HingeFit& fit, const HingeProblem& problem) {
    const auto base = problem.base.cols();
    const double spread = (problem.y.array() - problem.y.mean()).matrix().norm();
    std::ptrdiff_t weakest = -1;
    double lowest = 4.0;
    for (std::size_t s = 0; s < fit.hinges.size(); ++s) {
        const auto& hinge = fit.hinges[s];
        const Eigen::Index k = base + static_cast<Eigen::Index>(s);
        const double slope = fit.estimates.value[k];
        double reach = 0;  // norm of the hinge's column
        for (const double q : problem.q) reach = std::hypot(reach, std::max(hinge.side * (q - hinge.position), 0.0));
        const double error = std::sqrt(fit.estimates.covariance(k, k));
        double clarity = std::isfinite(error) && error > 0 ? std::abs(slope) / error : 0.0;
        if (std::abs(slope) * reach < 1e-3 * spread) clarity = 0;
        if (clarity < lowest) {
            lowest = clarity;
            weakest = static_cast<std::ptrdiff_t>(s);
        }
    }
    return weakest;
}

/// Of two stops on one side the nearer one is reached first: hinges go to the stops in the order of the model's
/// clearances. `reached` holds the stop of each hinge.
void sortReached(const std::vector<Stop>& stops, const std::vector<Hinge>& hinges, std::vector<std::size_t>& reached) {
    for (const Side side : {Side::positive, Side::negative}) {
        std::vector<std::size_t> candidates, order;  // stops; places in `reached`
        for (std::size_t i = 0; i < stops.size(); ++i)
            if (stops[i].side == side) candidates.push_back(i);
        for (std::size_t k = 0; k < reached.size(); ++k)
            if (stops[reached[k]].side == side) order.push_back(k);
        std::sort(candidates.begin(), candidates.end(),
                  [&](std::size_t a, std::size_t b) { return stops[a].clearance < stops[b].clearance; });
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return std::abs(hinges[a].position) < std::abs(hinges[b].position);
        });
        for (std::size_t k = 0; k < order.size(); ++k) reached[order[k]] = candidates[k];
    }
}

}  // namespace

std::size_t findElement(const MountModel& model, const std::string& name) {
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        if (model.connections[i].name == name) return i;
    if (model.connections.size() == 1) return 0;
    return static_cast<std::size_t>(model.connectionIndex(name));  // throws, naming those that exist
}

ComponentOptions completeOptions(const Recording& recording, const MountModel& model, ComponentOptions options) {
    if (recording.connections(Part::force).empty() && !options.mass) options.mass = model.body.mass;
    return options;
}

ComponentFit fitComponent(const std::vector<Recording>& recordings, const MountModel& model,
                          const ComponentOptions& options) {
    const Stack stack = stackRecordings(recordings, options, model);
    const ComponentData& data = stack.all;
    ComponentFit fit;
    fit.connection = data.connection;
    fit.axis = data.axis;
    fit.notes = data.notes;
    fit.fitted = model;
    const std::size_t connection = findElement(model, data.connection);
    AxisLaw& law = fit.fitted.connections[connection].axis[data.axis];

    const std::string dropped = keepFittedTerms(law);
    if (!dropped.empty()) fit.notes.push_back(dropped);

    const auto columns = makeColumns(stack, law);
    HingeProblem problem;
    problem.q = data.q;
    const AxisLaw known = pickKnown(law);
    problem.y = known == AxisLaw{} ? data.force : data.force - stackForce(stack, known);
    problem.run_starts = stack.run_starts;
    problem.base.resize(data.count(), columns.size());
    for (std::size_t j = 0; j < columns.size(); ++j) problem.base.col(j) = columns[j].values;
    std::vector<std::size_t> reached;  // stops that the data show
    for (std::size_t i = 0; i < law.stops.size(); ++i) {
        const int side = law.stops[i].side == Side::positive ? 1 : -1;
        problem.start.push_back({side, side * law.stops[i].clearance});
        reached.push_back(i);
    }
    HingeFit result;
    while (!problem.start.empty()) {
        result = fitHinges(problem, false);
        const auto unreached = findUnreachedStop(result, problem);
        if (unreached < 0) break;
        problem.start.erase(problem.start.begin() + unreached);
        reached.erase(reached.begin() + unreached);
    }
    if (problem.start.empty()) result = HingeFit{{}, solveBlocks(problem.base, problem.y, problem.run_starts)};
    sortReached(law.stops, result.hinges, reached);
    const Estimates& e = result.estimates;
    fit.gains = gainTolerancesOf(data.source, model);
    const double spread = (data.force.array() - data.force.mean()).matrix().norm();
    fit.residual_fraction = spread > 0 ? e.residual.norm() / spread : 0;
    fit.residual_rms = e.residual.norm() / std::sqrt(static_cast<double>(data.count()));
    fit.effective_samples = static_cast<double>(data.count()) / e.correlation_length;

    const std::string place = data.connection + "." + "xyz"[data.axis] + ".";
    const auto add = [&](const std::string& name, const std::string& unit, double value, double half) {
        if (!std::isfinite(half)) {
            fit.not_identifiable.push_back({place + name, adviseOn(name)});
            return false;
        }
        fit.parameters.push_back({place + name, value, unit, value - half, value + half});
        return true;
    };
    for (std::size_t j = 0; j < columns.size(); ++j) {
        const Eigen::Index k = j;
        const double value = e.value[k];
        if (!add(columns[j].name, columns[j].unit, value, e.calcHalfWidth(k))) continue;
        if (columns[j].member != nullptr) law.*columns[j].member = value;
        if (columns[j].name == "friction_force") law.friction->force = value;
        if (columns[j].name == "force_offset") fit.force_offset = value;
    }
    const Eigen::Index base = columns.size();
    const Eigen::Index stops = reached.size();
    for (std::size_t i = 0; i < law.stops.size(); ++i) {
        const std::string name = stopName(law.stops, i);
        const auto found = std::find(reached.begin(), reached.end(), i);
        if (found == reached.end()) {
            for (const char* what : {".clearance", ".stiffness"})
                fit.not_identifiable.push_back({place + name + what, "a test that travels beyond this stop"});
            continue;
        }
        const Eigen::Index k = found - reached.begin();
        const double clearance = std::abs(result.hinges[k].position);
        if (add(name + ".clearance", "m", clearance, e.calcHalfWidth(base + stops + k)))
            law.stops[i].clearance = clearance;
        if (add(name + ".stiffness", "N/m", e.value[base + k], e.calcHalfWidth(base + k)))
            law.stops[i].stiffness = e.value[base + k];
    }
    // A model cannot hold a negative dashpot or friction; a delay between the channels of f and q makes one.
    if (law.damping < 0) {
        fit.notes.emplace_back(
            "the dashpot came out negative: zero in the fitted model (a force channel late against "
            "the displacement's does that)");
        law.damping = 0;
    }
    if (law.friction && law.friction->force < 0) {
        fit.notes.emplace_back("the friction came out negative: left out of the fitted model");
        law.friction.reset();
    }
    if (law.stiffness < 0) {
        fit.notes.emplace_back("the stiffness came out negative: zero in the fitted model");
        law.stiffness = 0;
    }
    if (data.qualitative)
        fit.notes.emplace_back("other connections act on the same body: these values are qualitative");
    return fit;
}

}  // namespace wems::identify
