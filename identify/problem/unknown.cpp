#include "identify/problem/unknown.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/guided_motion.hpp"
#include "models/model_tolerance.hpp"
#include "models/parameter_access.hpp"
#include "models/parameter_name.hpp"
#include "models/tolerances.hpp"

namespace wems::identify {
namespace {

// A number that a hypothesis sets free may be off by this part of itself; beyond it the reader would have noticed.
constexpr double kReach = 0.5;
// Of the largest velocity: where friction is sought first to fade, since 1 mm/s, the law's default, suits one speed of
// motion. From here a twelfth was found on eight of eight random devices, a sixth on three of four: the other one was
// told as a dashpot. Other values were not tried.
constexpr double kTransition = 0.02;
constexpr double kSmallStep = 1e-3;  // of the reach: finite differences of smooth laws, far above round-off

double findTolerance(ToleranceOf what, const Tolerances& own, const Tolerances& all) {
    if (const auto given = own.find(what)) return *given;
    if (const auto given = all.find(what)) return *given;
    return keyOf(what).standard;
}

class TableMaker {
public:
    TableMaker(const TestState& believed, const SensorLayout& layout, const TestScales& scales)
        : believed_(believed), model_(believed.model), layout_(layout), scales_(scales) {}

    UnknownTable make(const LoadedAxes& loaded) {
        addLaws();
        addBody();
        addModes();
        if (std::count(loaded.begin(), loaded.end(), true) > 0) addLoad(loaded);
        addSensors();
        return std::move(table_);
    }

private:
    double tolerance(ToleranceOf what, const Tolerances& own) const {
        return findTolerance(what, own, model_.tolerances);
    }

    void add(UnknownKind kind, const std::string& name, const std::string& unit, double tolerance, double reach,
             int first, int second, std::function<double(const TestState&)> get,
             std::function<void(TestState&, double)> set, double least = -std::numeric_limits<double>::infinity()) {
        if (!(reach > 0)) return;
        Unknown row;
        row.kind = kind;
        row.name = name;
        row.unit = unit;
        row.deviation = 0.5 * tolerance;
        row.reach = reach;
        row.step = kSmallStep * reach;
        row.first = first;
        row.second = second;
        row.least = least;
        row.most = std::numeric_limits<double>::infinity();
        row.get = std::move(get);
        row.set = std::move(set);
        row.believed = row.get(believed_);
        table_.push_back(std::move(row));
    }

    /// A number of an axis' law.
    void addLaw(int i, int a, const std::string& key, const std::string& unit, double tolerance, double reach,
                const std::function<double(const AxisLaw&)>& get, const std::function<void(AxisLaw&, double)>& set,
                double least = -std::numeric_limits<double>::infinity()) {
        const auto c = static_cast<std::size_t>(i), k = static_cast<std::size_t>(a);
        add(
            UnknownKind::law, model_.connections[c].name + "." + kAxes[k] + "." + key, unit, tolerance, reach, i, a,
            [=](const TestState& state) { return get(state.model.connections[c].axis[k]); },
            [=](TestState& state, double value) { set(state.model.connections[c].axis[k], value); }, least);
    }

    void addNumber(int i, int a, const char* key, double AxisLaw::*member, const char* unit, double tolerance,
                   double reach, double least = -std::numeric_limits<double>::infinity()) {
        addLaw(
            i, a, key, unit, tolerance, reach, [member](const AxisLaw& law) { return law.*member; },
            [member](AxisLaw& law, double value) { law.*member = value; }, least);
    }

    double scaleOf(const AxisLaw& law) const { return law.stiffness > 0 ? law.stiffness : largest_stiffness_; }  // N/m

    void addAxis(int i, int a) {
        const Connection& connection = model_.connections[i];
        const AxisLaw& law = connection.axis[a];
        const Tolerances& own = connection.axis_tolerances[a];
        const double k = scaleOf(law);
        const double q = scales_.displacement, v = scales_.velocity;
        const double force = k * q;
        addNumber(i, a, "stiffness", &AxisLaw::stiffness, "N/m", tolerance(ToleranceOf::stiffness, own) * law.stiffness,
                  kReach * k, 0);
        // A dashpot that takes a tenth of the elastomer's force at the largest velocity.
        const double dashpot = std::max(law.damping, 0.1 * force / v);
        addNumber(i, a, "damping", &AxisLaw::damping, "N s/m", tolerance(ToleranceOf::damping, own) * law.damping,
                  2 * dashpot, 0);
        addNumber(i, a, "quadratic", &AxisLaw::quadratic, "N/m^2", 0, kReach * k / q);
        addNumber(i, a, "cubic", &AxisLaw::cubic, "N/m^3", 0, kReach * k / (q * q));
        addNumber(i, a, "loss_factor", &AxisLaw::loss_factor, "-", 0, 0.2, 0);
        addNumber(i, a, "drift", &AxisLaw::drift, "1/s", 0, kReach / scales_.duration);
        // Equal guides rub alike, whatever the elastomers beside them: one size along a direction.
        double all = 0;
        for (const auto& other : model_.connections) all += scaleOf(other.axis[a]);
        addFriction(i, a, 0.2 * q * all / static_cast<double>(model_.connections.size()), kTransition * v);
        addLaw(
            i, a, "stiffness_ratio", "-", 0, 0.5,
            [](const AxisLaw& l) { return l.relaxation ? l.relaxation->stiffness_ratio : 0.0; },
            [](AxisLaw& l, double value) {
                if (l.relaxation)
                    l.relaxation->stiffness_ratio = value;
                else if (value != 0)
                    l.relaxation = Relaxation{value, 0.01};
            },
            0);
        const double tau = 1 / (kTwoPi * std::sqrt(scales_.lowest * scales_.highest));
        addLaw(
            i, a, "time_constant", "s", 0, 2 * tau,
            [tau](const AxisLaw& l) { return l.relaxation ? l.relaxation->time_constant : tau; },
            [](AxisLaw& l, double value) {
                if (!l.relaxation) l.relaxation = Relaxation{0, value};
                l.relaxation->time_constant = value;
            },
            1e-3 * tau);
        table_.back().step = 1e-3 * tau;
        addHysteresis(i, a, 0.2 * force, 0.2 * q);
        if (law.stops.empty()) return;
        addNumber(i, a, "offset", &AxisLaw::offset, "m", 0, kReach * law.stops.front().clearance);
        for (std::size_t s = 0; s < law.stops.size(); ++s) {
            const Stop& stop = law.stops[s];
            const bool dormant = stop.stiffness == 0;
            const std::string side = stop.side == Side::positive ? "+" : "-";
            addLaw(
                i, a, side + ".clearance", "m", dormant ? 0 : tolerance(ToleranceOf::clearance, own) * stop.clearance,
                kReach * stop.clearance, [s](const AxisLaw& l) { return l.stops[s].clearance; },
                [s](AxisLaw& l, double value) { l.stops[s].clearance = value; }, 1e-3 * stop.clearance);
            addLaw(
                i, a, side + ".stiffness", "N/m",
                dormant ? 0 : tolerance(ToleranceOf::stop_stiffness, own) * stop.stiffness,
                dormant ? std::max(largest_stop_, 10 * k) : stop.stiffness,
                [s](const AxisLaw& l) { return l.stops[s].stiffness; },
                [s](AxisLaw& l, double value) { l.stops[s].stiffness = value; }, 0);
        }
        // A dissipation that doubles the stop's force at the largest velocity.
        addLaw(
            i, a, "dissipation", "s/m", 0, 1 / v, [](const AxisLaw& l) { return l.stops.front().dissipation; },
            [](AxisLaw& l, double value) {
                for (Stop& stop : l.stops) stop.dissipation = value;
            },
            0);
    }

    /// A number of a mechanism that the law may lack; setting it begins the mechanism.
    template <class Mechanism>
    void addNumberOf(int i, int a, std::optional<Mechanism> AxisLaw::*mechanism, const Mechanism& begun,
                     double Mechanism::*member, const char* key, const char* unit, double reach, double least) {
        addLaw(
            i, a, key, unit, 0, reach, [=](const AxisLaw& law) { return (law.*mechanism).value_or(begun).*member; },
            [=](AxisLaw& law, double value) {
                if (!(law.*mechanism)) law.*mechanism = begun;
                (*(law.*mechanism)).*member = value;
            },
            least);
    }

    /// @param size of its force, N
    /// @param transition velocity below which it fades if the model does not say, m/s
    void addFriction(int i, int a, double size, double transition) {
        const Friction begun{0, transition, {}};
        addNumberOf(i, a, &AxisLaw::friction, begun, &Friction::force, "friction_force", "N", size, 0);
        addNumberOf(i, a, &AxisLaw::friction, begun, &Friction::transition_velocity, "transition_velocity", "m/s",
                    transition, 1e-3 * transition);
    }

    /// @param size of its force, N
    /// @param yield where it slides if the model does not say, m
    void addHysteresis(int i, int a, double size, double yield) {
        const Hysteresis begun{0, yield, 1, 0.5};
        addNumberOf(i, a, &AxisLaw::hysteresis, begun, &Hysteresis::force, "hysteresis_force", "N", size, 0);
        addNumberOf(i, a, &AxisLaw::hysteresis, begun, &Hysteresis::yield_displacement, "yield_displacement", "m",
                    yield, 1e-3 * yield);
    }

    void addLaws() {
        for (const auto& connection : model_.connections)
            for (const auto& law : connection.axis) {
                largest_stiffness_ = std::max(largest_stiffness_, law.stiffness);
                for (const auto& stop : law.stops) largest_stop_ = std::max(largest_stop_, stop.stiffness);
            }
        const GuidedMotion guide(model_.body);
        for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i) {
            const std::size_t c = i;
            const Connection& connection = model_.connections[c];
            for (int a = 0; a < 3; ++a)
                if (guide.moves(connection.position, a)) addAxis(i, a);
            const double known = tolerance(ToleranceOf::position, connection.tolerances);
            for (int a = 0; a < 3; ++a)
                add(
                    UnknownKind::position, connection.name + ".position." + kAxes[a], "m", known, 1e-2, i, a,
                    [c, a](const TestState& state) { return state.model.connections[c].position[a]; },
                    [c, a](TestState& state, double value) { state.model.connections[c].position[a] = value; });
        }
    }

    void addBody() {
        const MobileBody& body = model_.body;
        add(
            UnknownKind::body, "body.mass", "kg", tolerance(ToleranceOf::mass, body.tolerances) * body.mass,
            kReach * body.mass, 0, 0, [](const TestState& state) { return state.model.body.mass; },
            [](TestState& state, double value) { state.model.body.mass = value; }, 0.01 * body.mass);
        double size = 0;
        for (const auto& connection : model_.connections) size = std::max(size, connection.position.norm());
        if (size == 0) size = std::sqrt(body.inertia.trace() / body.mass);
        for (int a = 0; a < 3; ++a)
            add(
                UnknownKind::body, std::string("body.center_of_gravity.") + kAxes[a], "m",
                tolerance(ToleranceOf::center_of_gravity, body.tolerances), size, 1, a,
                [a](const TestState& state) { return state.model.body.center_of_gravity[a]; },
                [a](TestState& state, double value) { state.model.body.center_of_gravity[a] = value; });
        for (int e = 0; e < 6; ++e) {
            static constexpr int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
            const int r = row[e], c = column[e];
            const double size_of = std::sqrt(body.inertia(r, r) * body.inertia(c, c));
            add(
                UnknownKind::body, std::string("body.inertia.") + kInertiaNames[e], "kg m^2",
                tolerance(ToleranceOf::inertia, body.tolerances) * size_of, kReach * size_of, 2, e,
                [r, c](const TestState& state) { return state.model.body.inertia(r, c); },
                [r, c](TestState& state, double value) {
                    state.model.body.inertia(r, c) = state.model.body.inertia(c, r) = value;
                },
                r == c ? 0.01 * size_of : -size_of);
        }
        const double spin = body.inertia.trace() / 3 * kTwoPi * std::sqrt(scales_.lowest * scales_.highest);
        for (int a = 0; a < 3; ++a)
            add(
                UnknownKind::body, std::string("body.spin.") + kAxes[a], "N m s", 0, spin, 3, a,
                [a](const TestState& state) { return state.model.body.spin[a]; },
                [a](TestState& state, double value) { state.model.body.spin[a] = value; });
    }

    void addModes() {
        for (std::size_t j = 0; j < model_.bracket.size(); ++j) {
            const BracketMode& mode = model_.bracket[j];
            const std::string row = std::to_string(j + 1);
            const int index = static_cast<int>(j);
            add(
                UnknownKind::mode, row + ".frequency", "Hz",
                tolerance(ToleranceOf::mode_frequency, mode.tolerances) * mode.frequency, 0.2 * mode.frequency, index,
                0, [j](const TestState& state) { return state.model.bracket[j].frequency; },
                [j](TestState& state, double value) { state.model.bracket[j].frequency = value; },
                0.1 * mode.frequency);
            const double ratio = mode.damping_ratio > 0 ? mode.damping_ratio : 0.01;
            add(
                UnknownKind::mode, row + ".damping_ratio", "-",
                tolerance(ToleranceOf::mode_damping_ratio, mode.tolerances) * mode.damping_ratio, 2 * ratio, index, 1,
                [j](const TestState& state) { return state.model.bracket[j].damping_ratio; },
                [j](TestState& state, double value) { state.model.bracket[j].damping_ratio = value; }, 1e-3 * ratio);
            addShape(index, "u", &BracketMode::translation, 0);
            addShape(index, "r", &BracketMode::rotation, 3);
            addShape(index, "load.u", &BracketMode::load_translation, 6);
            addShape(index, "base.u", &BracketMode::base_participation, 9);
        }
    }

    void addShape(int index, const char* prefix, Eigen::Vector3d BracketMode::*member, int first) {
        const std::size_t j = index;
        const BracketMode& mode = model_.bracket[j];
        const bool turns = first == 3, of_base = first == 9;
        // Of a mode without a shape, which is yet to be found, the base's part is too.
        if (of_base && !(mode.translation.isZero(0.0) && mode.rotation.isZero(0.0))) return;
        const double size =
            turns     ? mode.rotation.cwiseAbs().maxCoeff()
            : of_base ? mode.base_participation.cwiseAbs().maxCoeff()
                      : std::max(mode.translation.cwiseAbs().maxCoeff(), mode.load_translation.cwiseAbs().maxCoeff());
        for (int a = 0; a < 3; ++a)
            add(
                UnknownKind::shape, std::to_string(index + 1) + "." + prefix + kAxes[a],
                turns ? "kg^-1/2 m^-1" : (of_base ? "kg^1/2" : "kg^-1/2"),
                tolerance(ToleranceOf::mode_shape, mode.tolerances) * size, size > 0 ? size : 1.0, index, first + a,
                [j, member, a](const TestState& state) { return (state.model.bracket[j].*member)[a]; },
                [j, member, a](TestState& state, double value) { (state.model.bracket[j].*member)[a] = value; });
    }

    void addLoad(const LoadedAxes& loaded) {
        const double known = tolerance(ToleranceOf::load_gain, {});
        add(
            UnknownKind::load, "load.gain", "-", known, 0.5, 0, 3,
            [](const TestState& state) {
                const auto& load = state.model.load;
                // A table over frequency has no single gain.
                return load && load->gain_over_frequency.size() == 1 ? load->gain_over_frequency.front().second : 1.0;
            },
            [](TestState& state, double value) {
                if (state.model.load && state.model.load->gain_over_frequency.size() > 1) return;
                if (!state.model.load) state.model.load.emplace();
                state.model.load->gain_over_frequency = {{0.0, value}};
            },
            0.01);
        // One axis alone has no gain beside that of all.
        if (std::count(loaded.begin(), loaded.end(), true) < 2) return;
        for (std::size_t a = 0; a < 3; ++a) {
            if (!loaded.at(a)) continue;
            const Eigen::Index axis = a;
            add(
                UnknownKind::load, std::string("load.gain.") + kAxes[a], "-", known, 0.5, 0, static_cast<int>(a),
                [axis](const TestState& state) { return state.model.load ? state.model.load->axis_gain[axis] : 1.0; },
                [axis](TestState& state, double value) {
                    if (!state.model.load) state.model.load = LoadCorrection{{{0.0, 1.0}}};
                    state.model.load->axis_gain[axis] = value;
                },
                0.01);
        }
    }

    void addSensors() {
        // What is stated of the first channel of a triax, or of a place, is stated of all.
        const auto firstOf = [&](int SensorChannel::*group, std::size_t index) {
            const auto& all = layout_.channels;
            return std::find_if(all.begin(), all.end(),
                                [&](const SensorChannel& channel) { return channel.*group == static_cast<int>(index); })
                ->name;
        };
        for (std::size_t c = 0; c < layout_.channels.size(); ++c) {
            const auto& channel = layout_.channels[c];
            const auto own = sensorTolerances(model_, channel.name);
            const Eigen::Index index = c;
            const int id = static_cast<int>(c);
            add(
                UnknownKind::channel_gain, channel.name + ".gain", "-", tolerance(ToleranceOf::sensor_gain, own), 0.3,
                id, 0, [index](const TestState& state) { return 1 + state.sensors.gain[index]; },
                [index](TestState& state, double value) { state.sensors.gain[index] = value - 1; }, 0.01);
            add(
                UnknownKind::channel_delay, channel.name + ".delay", "s", tolerance(ToleranceOf::sensor_delay, own),
                0.1 / scales_.highest, id, 0, [index](const TestState& state) { return state.sensors.delay[index]; },
                [index](TestState& state, double value) { state.sensors.delay[index] = value; });
        }
        for (std::size_t t = 0; t < layout_.triaxes.size(); ++t) {
            const auto& triax = layout_.triaxes[t];
            const auto own = sensorTolerances(model_, firstOf(&SensorChannel::triax, t));
            for (int a = 0; a < 3; ++a) {
                const Eigen::Index index = t;
                add(
                    UnknownKind::triax_rotation, triax.name + ".r" + kAxes[a], "rad",
                    tolerance(ToleranceOf::sensor_rotation, own), 0.3, static_cast<int>(t), a,
                    [index, a](const TestState& state) { return state.sensors.rotation(a, index); },
                    [index, a](TestState& state, double value) { state.sensors.rotation(a, index) = value; });
            }
        }
        for (std::size_t s = 0; s < layout_.stations.size(); ++s) {
            const auto own = sensorTolerances(model_, firstOf(&SensorChannel::station, s));
            for (int a = 0; a < 3; ++a) {
                const Eigen::Index index = s;
                add(
                    UnknownKind::station_place, layout_.stations[s] + ".position." + kAxes[a], "m",
                    tolerance(ToleranceOf::sensor_position, own), 1e-2, static_cast<int>(s), a,
                    [index, a](const TestState& state) { return state.sensors.place(a, index); },
                    [index, a](TestState& state, double value) { state.sensors.place(a, index) = value; });
            }
        }
        for (const Part part : {Part::mobile, Part::fixed}) {
            if (!layout_.hasAccelerations(part)) continue;
            const std::size_t side = part == Part::mobile ? 0 : 1;
            // What AC coupling a laboratory leaves on: a corner a decade or more below the lowest frequency.
            add(
                UnknownKind::corner, side == 0 ? "mobile.a.corner" : "fixed.a.corner", "Hz", 0.2 * scales_.lowest,
                scales_.lowest, static_cast<int>(side), 0,
                [side](const TestState& state) { return state.sensors.corner[side]; },
                [side](TestState& state, double value) { state.sensors.corner[side] = value; });
        }
    }

    const TestState& believed_;
    const MountModel& model_;
    const SensorLayout& layout_;
    const TestScales& scales_;
    double largest_stiffness_ = 0, largest_stop_ = 0;
    UnknownTable table_;
};

}  // namespace

UnknownTable makeUnknownTable(const TestState& believed, const SensorLayout& layout, const TestScales& scales,
                              const LoadedAxes& loaded) {
    return TableMaker(believed, layout, scales).make(loaded);
}

int findUnknown(const UnknownTable& table, const std::string& name) {
    const auto found = std::find_if(table.begin(), table.end(), [&](const Unknown& row) { return row.name == name; });
    return found == table.end() ? -1 : static_cast<int>(found - table.begin());
}

}  // namespace wems::identify
