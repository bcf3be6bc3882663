#include "identify/exact/catalogue.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "models/axis_law.hpp"
#include "models/axis_numbers.hpp"
#include "models/common/format_number.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

constexpr double kLongestDelay = 0.02;  // s
constexpr double kLargestGain = 2.0;    // of a side of sensors or the load

bool endsWith(const std::string& name, const std::string& ending) {
    return name.size() >= ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
}

/// Parameters of either sign.
bool isSigned(const std::string& name) {
    if (const AxisNumber* number = findAxisNumber(name.substr(name.rfind('.') + 1)))
        return number->range == AxisNumber::Range::any;
    for (const char* ending :
         {".x", ".y", ".z", "Ixy", "Ixz", "Iyz", ".delay", ".rx", ".ry", ".rz", ".ux", ".uy", ".uz"})
        if (endsWith(name, ending)) return true;
    return false;
}

}  // namespace

double Knob::get(const MountModel& model) const {
    const double value = getParameter(model, names.front());
    return isFactor() ? value / base.front() : value;
}

void Knob::set(MountModel& model, double value) const {
    for (std::size_t i = 0; i < names.size(); ++i) setParameter(model, names[i], isFactor() ? value * base[i] : value);
    if (!load_point) return;
    auto& mode = model.bracket[load_point->mode];
    mode.load_translation = mode.translation + mode.rotation.cross(load_point->position);
}

double Knob::scale(const MountModel& model) const {
    return isFactor() ? 1.0 : parameterScale(model, names.front());
}

double Knob::lowest(const MountModel& model) const {
    if (isFactor()) return 0.0;
    const auto& name = names.front();
    if (endsWith(name, ".delay")) return -kLongestDelay;
    if (endsWith(name, ".gain")) return 1 / kLargestGain;
    if (isSigned(name)) return -std::numeric_limits<double>::infinity();
    if (endsWith(name, ".clearance")) return 1e-5;
    if (endsWith(name, ".time_constant")) return 2e-4;
    if (endsWith(name, ".transition_velocity")) return 1e-5;
    if (endsWith(name, "body.mass") || endsWith(name, "Ixx") || endsWith(name, "Iyy") || endsWith(name, "Izz") ||
        endsWith(name, ".frequency"))
        return 0.05 * parameterScale(model, name);
    return 0.0;
}

double Knob::highest(const MountModel&) const {
    if (endsWith(names.front(), ".loss_factor")) return 0.9 * largestLossFactor();
    if (endsWith(names.front(), ".time_constant")) return 1.0;
    if (endsWith(names.front(), ".damping_ratio")) return 0.5;
    if (endsWith(names.front(), ".delay")) return kLongestDelay;
    if (endsWith(names.front(), ".gain")) return kLargestGain;
    return std::numeric_limits<double>::infinity();
}

Knob makeKnob(const std::string& name) {
    return {{name}, {}};
}

Knob makeSharedKnob(std::vector<std::string> names) {
    return {std::move(names), {}};
}

Knob makeFactorKnob(const MountModel& model, const std::vector<std::string>& names) {
    Knob knob;
    for (const auto& name : names) {
        const double value = getParameter(model, name);
        if (value == 0) continue;
        knob.names.push_back(name);
        knob.base.push_back(value);
    }
    return knob;
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Places of elastomers: each axis alone, those along one mount axis together, the lateral ones, all.
struct Place {
    std::vector<std::string> axes;  // `1.z`
    bool single() const { return axes.size() == 1; }
};

std::vector<Place> listPlaces(const MountModel& model) {
    std::vector<Place> places;
    Place along[3], lateral, all;
    for (const auto& connection : model.connections)
        for (std::size_t a = 0; a < 3; ++a) {
            const auto& law = connection.axis[a];
            if (law.stiffness == 0 && law.damping == 0 && law.stops.empty()) continue;
            const std::string axis = connection.name + "." + kAxes[a];
            places.push_back({{axis}});
            along[a].axes.push_back(axis);
            if (a < 2) lateral.axes.push_back(axis);
            all.axes.push_back(axis);
        }
    for (const auto& place : {along[0], along[1], along[2], lateral, all})
        if (place.axes.size() > 1 && (places.empty() || place.axes != places.back().axes)) places.push_back(place);
    return places;
}

std::vector<std::string> withParameter(const Place& place, const std::string& parameter) {
    std::vector<std::string> names;
    for (const auto& axis : place.axes) names.push_back(axis + "." + parameter);
    return names;
}

void addBody(const MountModel& model, std::vector<Candidate>& list) {
    const auto add = [&](const std::string& cause, const std::vector<std::string>& names, double fraction) {
        Candidate candidate{cause, {"body"}, {}, {}, {{}}, names.size()};
        for (const auto& name : names) {
            candidate.knobs.push_back(makeKnob(name));
            candidate.starts[0].push_back(getParameter(model, name) + fraction * parameterScale(model, name));
        }
        list.push_back(candidate);
    };
    add("cog_offset", {"body.center_of_gravity.x", "body.center_of_gravity.y", "body.center_of_gravity.z"}, 0.3);
    add("mass", {"body.mass"}, 0.03);
    add("inertia", {"body.inertia.Ixx", "body.inertia.Iyy", "body.inertia.Izz"}, 0.3);
    add("inertia",
        {"body.inertia.Ixx", "body.inertia.Iyy", "body.inertia.Izz", "body.inertia.Ixy", "body.inertia.Ixz",
         "body.inertia.Iyz"},
        0.3);
    add("gyroscopic", {"body.spin.x", "body.spin.y", "body.spin.z"}, 0.3);
}

void addElastomer(const MountModel& model, std::vector<Candidate>& list) {
    for (const auto& place : listPlaces(model)) {
        const auto shared = [&](const std::string& cause, const std::string& parameter, double trial) {
            list.push_back({cause, place.axes, {makeSharedKnob(withParameter(place, parameter))}, {}, {{trial}}, 1});
        };
        const auto& first = place.axes.front();
        const double stiffness = getParameter(model, first + ".stiffness");
        if (stiffness > 0) {
            const auto factor = makeFactorKnob(model, withParameter(place, "stiffness"));
            list.push_back({"elastomer_stiffness", place.axes, {factor}, {}, {{1.05}}, 1});
            if (place.single()) list.back().knobs = {makeKnob(first + ".stiffness")};
            if (place.single()) list.back().starts = {{1.05 * stiffness}};
            shared("structural_damping", "loss_factor", getParameter(model, first + ".loss_factor") + 0.02);
            shared("stiffness_drift", "drift", getParameter(model, first + ".drift") + 1e-3);
            shared("cubic_stiffness", "cubic",
                   getParameter(model, first + ".cubic") + 0.1 * parameterScale(model, first + ".stiffness") / 1e-6);
            Candidate relaxation{"relaxation",
                                 place.axes,
                                 {makeSharedKnob(withParameter(place, "stiffness_ratio")),
                                  makeSharedKnob(withParameter(place, "time_constant"))},
                                 {},
                                 {},
                                 1};
            for (const double time_constant : {1e-3, 3e-3, 8e-3, 0.02, 0.06, 0.2})
                relaxation.starts.push_back({0.1, time_constant});
            list.push_back(relaxation);
        }
        const auto dampers = makeFactorKnob(model, withParameter(place, "damping"));
        if (place.single()) {
            const std::string name = first + ".damping";
            list.push_back({"viscous_damping",
                            place.axes,
                            {makeKnob(name)},
                            {},
                            {{getParameter(model, name) + 0.2 * parameterScale(model, name)}},
                            1});
        } else if (!dampers.names.empty()) {
            list.push_back({"viscous_damping", place.axes, {dampers}, {}, {{1.2}}, 1});
        }
        Candidate friction{"friction",
                           place.axes,
                           {makeSharedKnob(withParameter(place, "friction_force")),
                            makeSharedKnob(withParameter(place, "transition_velocity"))},
                           {},
                           {},
                           1};
        for (const double velocity : {1e-3, 5e-3, 2e-2}) friction.starts.push_back({1.0, velocity});
        list.push_back(friction);
    }
}

/// Trial clearances as fractions of a known one.
void addStop(const MountModel& model, const std::string& axis, Side side, std::vector<Candidate>& list) {
    const std::string stop = axis + (side == Side::positive ? ".+" : ".-");
    const double clearance = getParameter(model, stop + ".clearance");
    if (std::isfinite(clearance)) {
        Candidate change{"clearance", {stop}, {makeKnob(stop + ".clearance")}, {}, {}, 1};
        for (const double factor : {0.5, 0.7, 0.85, 0.95, 1.05, 1.15, 1.3, 1.6})
            change.starts.push_back({factor * clearance});
        list.push_back(change);
        list.push_back({"clearance", {stop}, {}, {{stop + ".clearance", kInfinity}}, {{}}, 0});
        const double stiffness = getParameter(model, stop + ".stiffness");
        list.push_back({"stop_stiffness", {stop}, {makeKnob(stop + ".stiffness")}, {}, {{1.1 * stiffness}}, 1});
    } else {
        const double scale = parameterScale(model, stop + ".clearance");
        Candidate missing{"clearance", {stop}, {makeKnob(stop + ".stiffness"), makeKnob(stop + ".clearance")},
                          {},          {},     1};
        for (const double factor : {0.15, 0.3, 0.5, 0.7, 0.9, 1.1, 1.4, 1.8, 2.4})
            missing.starts.push_back({0.5 * parameterScale(model, stop + ".stiffness"), factor * scale});
        list.push_back(missing);
    }
}

void addStops(const MountModel& model, std::vector<Candidate>& list) {
    std::vector<std::string> lossy;
    for (const auto& connection : model.connections)
        for (std::size_t a = 0; a < 3; ++a) {
            const auto& law = connection.axis[a];
            const std::string axis = connection.name + "." + kAxes[a];
            if (law.stiffness == 0 && law.stops.empty()) continue;
            addStop(model, axis, Side::positive, list);
            addStop(model, axis, Side::negative, list);
            if (law.stops.empty()) continue;
            lossy.push_back(axis);
            Candidate preload{"preload", {axis}, {makeKnob(axis + ".offset")}, {}, {}, 1};
            const double now = getParameter(model, axis + ".offset");
            for (const double factor : {-0.4, -0.2, -0.08, 0.08, 0.2, 0.4})
                preload.starts.push_back({now + factor * law.stops.front().clearance});
            list.push_back(preload);
            list.push_back({"stop_dissipation",
                            {axis},
                            {makeKnob(axis + ".dissipation")},
                            {},
                            {{getParameter(model, axis + ".dissipation") + 0.2}},
                            1});
        }
    const auto together = [&](const std::vector<std::string>& axes) {
        Candidate candidate{"stop_dissipation", axes, {makeSharedKnob({})}, {}, {}, 1};
        for (const auto& axis : axes) candidate.knobs[0].names.push_back(axis + ".dissipation");
        candidate.starts = {{getParameter(model, candidate.knobs[0].names.front()) + 0.2}};
        list.push_back(candidate);
    };
    std::vector<std::string> axial, lateral;
    for (const auto& axis : lossy) (axis.back() == 'z' ? axial : lateral).push_back(axis);
    if (axial.size() > 1) together(axial);
    if (lateral.size() > 1) together(lateral);
    if (!axial.empty() && !lateral.empty()) together(lossy);
}

void addSurroundings(const MountModel& model, std::vector<Candidate>& list) {
    for (std::size_t j = 0; j < model.bracket.size(); ++j) {
        const std::string mode = std::to_string(j + 1);
        Candidate change{"bracket_mode", {"bracket"}, {makeKnob(mode + ".frequency")}, {}, {}, 1};
        const double frequency = model.bracket[j].frequency;
        for (const double factor : {0.8, 0.9, 0.96, 0.99, 1.01, 1.04, 1.1, 1.2})
            change.starts.push_back({factor * frequency});
        list.push_back(change);
        Candidate damping{"bracket_mode", {"bracket"}, {makeKnob(mode + ".damping_ratio")}, {}, {}, 1};
        damping.starts = {{1.2 * model.bracket[j].damping_ratio + 1e-3}};
        list.push_back(damping);
        Candidate both{
            "bracket_mode", {"bracket"}, {makeKnob(mode + ".frequency"), makeKnob(mode + ".damping_ratio")}, {}, {}, 2};
        for (const double factor : {0.9, 0.97, 0.99, 1.01, 1.03, 1.1})
            both.starts.push_back({factor * frequency, 1.2 * model.bracket[j].damping_ratio + 1e-3});
        list.push_back(both);
    }
    list.push_back({"load", {"load"}, {makeKnob("load.gain")}, {}, {{getParameter(model, "load.gain") + 0.05}}, 1});
}

/// Faults that all channels of a side share; those of single channels break rigidity and are found before.
void addSides(const MountModel& model, std::vector<Candidate>& list) {
    for (const std::string side : {"mobile", "fixed"}) {
        const auto now = [&](const std::string& name) { return getParameter(model, side + name); };
        list.push_back({"sensor_gain", {side}, {makeKnob(side + ".gain")}, {}, {{now(".gain") + 0.02}}, 1});
        list.push_back({"sensor_delay", {side}, {makeKnob(side + ".delay")}, {}, {{now(".delay") + 1e-4}}, 1});
        list.push_back({"sensor_misalignment",
                        {side},
                        {makeKnob(side + ".rx"), makeKnob(side + ".ry"), makeKnob(side + ".rz")},
                        {},
                        {{now(".rx") + 0.01, now(".ry") + 0.01, now(".rz") + 0.01}},
                        3});
    }
}

}  // namespace

std::vector<std::string> Candidate::parameterNames() const {
    std::vector<std::string> names;
    for (const auto& entry : fixed) names.push_back(entry.first);
    for (const auto& knob : knobs) names.insert(names.end(), knob.names.begin(), knob.names.end());
    return names;
}

std::string Candidate::describe() const {
    std::string text = cause;
    if (where.size() <= 3) {
        for (const auto& place : where) text += " " + place;
    } else {
        text += " " + where.front() + " … " + where.back();
    }
    if (new_mode) {
        text += " " + std::to_string(new_mode->row) + " (new)";
    } else if (cause == "bracket_mode") {
        for (const auto& knob : knobs) text += " " + knob.names.front();
    }
    if (knobs.empty()) text += " (removed)";
    return text;
}

void Candidate::apply(MountModel& model, const std::vector<double>& values) const {
    for (const auto& entry : fixed) setParameter(model, entry.first, entry.second);
    while (new_mode && static_cast<int>(model.bracket.size()) < new_mode->row) {
        BracketMode mode;
        mode.frequency = new_mode->mode.frequency;
        if (static_cast<int>(model.bracket.size()) + 1 == new_mode->row) mode = new_mode->mode;
        model.bracket.push_back(mode);
    }
    for (std::size_t i = 0; i < knobs.size(); ++i) knobs[i].set(model, values[i]);
}

std::vector<Candidate> makeCatalogue(const MountModel& model, bool with_bracket) {
    std::vector<Candidate> list;
    addBody(model, list);
    addElastomer(model, list);
    addStops(model, list);
    if (with_bracket) addSurroundings(model, list);
    addSides(model, list);
    return list;
}

}  // namespace wems::identify
