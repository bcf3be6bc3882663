#include "models/mount_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include "models/axis_numbers.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems {

namespace {

bool isOfBody(const Eigen::Matrix3d& inertia) {
    return findInertiaProblem(calcPrincipalMoments(inertia)).empty();
}

}  // namespace

Eigen::Vector3d calcPrincipalMoments(const Eigen::Matrix3d& inertia) {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

std::string findInertiaProblem(const Eigen::Vector3d& principal) {
    if (!(principal[0] > 0)) return "principal moments above 0, kg m^2";
    // A flat body meets the limit exactly; rounding must not turn it down.
    if (principal[2] > (principal[0] + principal[1]) * (1 + 1e-9))
        return "a real body's: no principal moment above the sum of the other two";
    return {};
}

Eigen::Matrix3d limitInertia(const Eigen::Matrix3d& believed, const Eigen::Matrix3d& wanted) {
    if (isOfBody(wanted)) return wanted;
    constexpr int halvings = 40;  // to 1e-12 of the way
    constexpr double kept = 0.99;
    const Eigen::Matrix3d way = wanted - believed;
    double inside = 0, outside = 1;
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (inside + outside);
        (isOfBody(believed + middle * way) ? inside : outside) = middle;
    }
    return believed + kept * inside * way;
}

namespace {

[[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& accepted = {}) {
    throw InputError({{}, 0, key}, problem, accepted);
}

void requireFinite(const std::string& key, const Eigen::Ref<const Eigen::MatrixXd>& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        const double value = values(i % values.rows(), i / values.rows());
        if (!std::isfinite(value)) fail(key, "holds " + formatNumber(value), "finite numbers");
    }
}

void requireFinite(const std::string& key, double value) {
    if (!std::isfinite(value)) fail(key, "is " + formatNumber(value), "a finite number");
}

/// Equations about the interface hold the inertia about the CoG beside mass x distance squared. Where that is too
/// large, their round-off is all that is left of the inertia.
void checkArm(const MobileBody& body, double least_moment) {
    constexpr double kept = 1e-6;  // of the inertia; no test tells it more closely
    const double moved = body.mass * body.center_of_gravity.squaredNorm();
    const double most = kept / std::numeric_limits<double>::epsilon() * least_moment;
    if (moved <= most) return;
    fail("body.center_of_gravity", "lies so far out that mass times distance squared is " + formatNumber(moved, 6),
         "at most " + formatNumber(most, 6) + " kg m^2, beside the least principal moment of the inertia");
}

void checkBody(const MobileBody& body) {
    if (!(std::isfinite(body.mass) && body.mass > 0)) {
        fail("body.mass", "is " + formatNumber(body.mass), "a number above 0, kg");
    }
    requireFinite("body.center_of_gravity", body.center_of_gravity);
    requireFinite("body.spin", body.spin);
    requireFinite("body.inertia", body.inertia);
    if (std::none_of(body.free.begin(), body.free.end(), [](bool free) { return free; }))
        fail("body.motion", "is empty", "at least one of x, y, z, rx, ry, rz");
    if (!body.inertia.isApprox(body.inertia.transpose(), 1e-12)) fail("body.inertia", "is not symmetric");
    const Eigen::Vector3d principal = calcPrincipalMoments(body.inertia);
    const std::string accepted = findInertiaProblem(principal);
    if (!accepted.empty())
        fail("body.inertia",
             "has the principal moments " + formatNumber(principal[0], 6) + ", " + formatNumber(principal[1], 6) +
                 ", " + formatNumber(principal[2], 6),
             accepted);
    checkArm(body, principal[0]);
}

void checkConnections(const std::vector<Connection>& connections) {
    if (connections.empty()) fail("connection", "there is none", "at least one [[connection]]");
    std::set<std::string> names;
    for (std::size_t i = 0; i < connections.size(); ++i) {
        const Connection& connection = connections[i];
        const std::string prefix = "connection[" + std::to_string(i) + "].";
        const auto forbidden = [](unsigned char c) {
            return std::isspace(c) != 0 || std::iscntrl(c) != 0 ||
                   std::string(".,;\"'[]").find(static_cast<char>(c)) != std::string::npos;
        };
        if (connection.name.empty() || std::any_of(connection.name.begin(), connection.name.end(), forbidden)) {
            fail(prefix + "name", "is \"" + connection.name + "\"",
                 "a name without blanks, dots, commas, semicolons, quotes and brackets, since it is part of channel "
                 "names");
        }
        if (!names.insert(connection.name).second) {
            fail(prefix + "name", "\"" + connection.name + "\" stands twice", "a name of its own for each connection");
        }
        requireFinite(prefix + "position", connection.position);
        for (std::size_t k = 0; k < 3; ++k) {
            if (const auto problem = findProblem(connection.axis[k])) {
                fail(prefix + "xyz"[k] + "." + problem->key, problem->problem, problem->accepted);
            }
        }
    }
}

void checkBracket(const std::vector<BracketMode>& modes) {
    for (std::size_t j = 0; j < modes.size(); ++j) {
        const std::string prefix = "bracket mode " + std::to_string(j + 1) + ", ";
        const BracketMode& mode = modes[j];
        if (!(std::isfinite(mode.frequency) && mode.frequency > 0)) {
            fail(prefix + "frequency", "is " + formatNumber(mode.frequency), "a number above 0, Hz");
        }
        if (!(std::isfinite(mode.damping_ratio) && mode.damping_ratio >= 0)) {
            fail(prefix + "damping_ratio", "is " + formatNumber(mode.damping_ratio), "a number from 0 on");
        }
        requireFinite(prefix + "translation", mode.translation);
        requireFinite(prefix + "rotation", mode.rotation);
        requireFinite(prefix + "load", mode.load_translation);
        requireFinite(prefix + "base", mode.base_participation);
    }
}

void checkLoad(const LoadCorrection& load) {
    requireFinite("load.axis_gain", load.axis_gain);
    const auto& rows = load.gain_over_frequency;
    if (rows.empty()) fail("load.gain_over_frequency", "is empty", "at least one [frequency, gain]");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::string key = rows.size() == 1 && rows[0].first == 0
                                    ? "load.gain"
                                    : "load.gain_over_frequency[" + std::to_string(i) + "]";
        requireFinite(key, rows[i].first);
        requireFinite(key, rows[i].second);
        if (rows[i].first < 0 || (i > 0 && rows[i].first <= rows[i - 1].first)) {
            fail(key, "the frequency is " + formatNumber(rows[i].first), "frequencies from 0 on, ascending, Hz");
        }
    }
}

bool isChannelOrGroup(const std::string& channel, const MountModel& model) {
    const std::size_t first_dot = channel.find('.');
    const std::string part = channel.substr(0, first_dot);
    if (part == "load" || part == "base") {
        const std::string letter = part == "load" ? "f" : "a";
        return first_dot == std::string::npos || channel == part + "." + letter + "x" ||
               channel == part + "." + letter + "y" || channel == part + "." + letter + "z";
    }
    if (part != "mobile" && part != "fixed" && part != "relative" && part != "force") return false;
    if (first_dot == std::string::npos) return true;
    const std::size_t second_dot = channel.find('.', first_dot + 1);
    const std::string name = channel.substr(first_dot + 1, second_dot - first_dot - 1);
    const auto isCalled = [&name](const auto& place) { return place.name == name; };
    const bool known = std::any_of(model.connections.begin(), model.connections.end(), isCalled) ||
                       std::any_of(model.places.begin(), model.places.end(), isCalled);
    if (!known || second_dot == std::string::npos) return known;
    static const std::set<std::string> quantities = {"x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az", "d", "v", "a"};
    return quantities.count(channel.substr(second_dot + 1)) == 1;
}

void checkSensors(const MountModel& model) {
    for (std::size_t i = 0; i < model.sensors.size(); ++i) {
        const SensorFault& sensor = model.sensors[i];
        const std::string prefix = "sensor[" + std::to_string(i) + "].";
        if (!isChannelOrGroup(sensor.channel, model)) {
            fail(prefix + "channel", "is \"" + sensor.channel + "\"",
                 "a channel such as mobile.1.az of a connection of this model, or what holds it: mobile.1.a, mobile.1, "
                 "mobile");
        }
        requireFinite(prefix + "gain", sensor.gain);
        requireFinite(prefix + "delay", sensor.delay);
        requireFinite(prefix + "rotation", sensor.rotation);
        requireFinite(prefix + "zero", sensor.zero);
        if (sensor.zero != 0 && !parseChannelName(sensor.channel))
            fail(prefix + "zero", "is that of \"" + sensor.channel + "\", whose channels have several units",
                 "one channel, such as mobile.1.z or load.fz");
    }
}

/// @param prefix full key of the table that holds them
void checkTolerances(const std::string& prefix, const Tolerances& tolerances) {
    for (std::size_t k = 0; k < kToleranceKeys.size(); ++k) {
        const auto given = tolerances.find(static_cast<ToleranceOf>(k));
        if (given && !(std::isfinite(*given) && *given >= 0))
            fail(prefix + "tolerance." + kToleranceKeys[k].key, "is " + formatNumber(*given), "a number from 0 on");
    }
}

void checkAllTolerances(const MountModel& model) {
    checkTolerances("", model.tolerances);
    checkTolerances("body.", model.body.tolerances);
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        const Connection& connection = model.connections[i];
        const std::string prefix = "connection[" + std::to_string(i) + "].";
        checkTolerances(prefix, connection.tolerances);
        for (std::size_t k = 0; k < 3; ++k) checkTolerances(prefix + "xyz"[k] + ".", connection.axis_tolerances[k]);
    }
    for (std::size_t j = 0; j < model.bracket.size(); ++j)
        checkTolerances("bracket mode " + std::to_string(j + 1) + ", ", model.bracket[j].tolerances);
    for (std::size_t i = 0; i < model.sensors.size(); ++i)
        checkTolerances("sensor[" + std::to_string(i) + "].", model.sensors[i].tolerances);
}

void checkPlaces(const MountModel& model) {
    for (const SensorPlace& place : model.places) {
        const std::string key = std::string(place.accelerometer ? "accelerometer" : "marker") + " " + place.name;
        requireFinite(key, place.position);
        requireFinite(key, place.rotation);
        requireFinite(key, place.noise);
        const bool taken = std::any_of(model.connections.begin(), model.connections.end(),
                                       [&](const Connection& connection) { return connection.name == place.name; });
        if (taken) fail(key, "is a connection's name", "a name of its own");
    }
}

}  // namespace

int MountModel::placeIndex(const ChannelName& channel) const {
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].name == channel.connection && places[i].part == channel.part &&
            places[i].measures(channel.derivative))
            return static_cast<int>(i);
    }
    return -1;
}

int MountModel::connectionIndex(const std::string& connection_name) const {
    std::string known;
    for (std::size_t i = 0; i < connections.size(); ++i) {
        if (connections[i].name == connection_name) return static_cast<int>(i);
        known += (i > 0 ? ", " : "") + connections[i].name;
    }
    throw InputError({}, "the model has no connection \"" + connection_name + "\"", known);
}

void validate(const MountModel& model) {
    requireFinite("gravity", model.gravity);
    checkBody(model.body);
    checkConnections(model.connections);
    checkBracket(model.bracket);
    for (const int index : model.replaced_modes) {
        if (index < 1 || index > static_cast<int>(model.bracket.size())) {
            fail("bracket.mode", "the modes file has no row " + std::to_string(index));
        }
    }
    if (model.load) checkLoad(*model.load);
    if (model.load_point) requireFinite("load.position", model.load_point->position);
    checkSensors(model);
    checkPlaces(model);
    checkAllTolerances(model);
}

namespace {

void raiseToZero(double& value, const std::string& name, const std::string& unit, std::vector<std::string>& notes) {
    if (!(value < 0)) return;
    notes.push_back(name + " is identified as " + formatNumber(value, 4) + (unit == "-" ? "" : " " + unit) +
                    "; the fitted model holds 0, since a value below is none of a passive element");
    value = 0;
}

std::string formatMoments(const Eigen::Matrix3d& inertia) {
    const Eigen::Vector3d principal = calcPrincipalMoments(inertia);
    return formatNumber(principal[0], 4) + ", " + formatNumber(principal[1], 4) + ", " + formatNumber(principal[2], 4);
}

}  // namespace

std::vector<std::string> makeAdmissible(const MountModel& believed, MountModel& model) {
    std::vector<std::string> notes;
    for (Connection& connection : model.connections) {
        for (std::size_t axis = 0; axis < connection.axis.size(); ++axis) {
            AxisLaw& law = connection.axis.at(axis);
            const std::string place = connection.name + "." + "xyz"[axis] + ".";
            for (const AxisNumber& number : kAxisNumbers)
                if (number.range == AxisNumber::Range::not_negative)
                    raiseToZero(law.*number.member, place + number.key, number.unit, notes);
            for (Stop& stop : law.stops)
                raiseToZero(stop.dissipation, place + (stop.side == Side::positive ? "+" : "-") + ".dissipation", "s/m",
                            notes);
            if (law.friction) raiseToZero(law.friction->force, place + "friction_force", "N", notes);
        }
    }
    if (!model.body.inertia.allFinite()) return notes;  // validate() says so
    const Eigen::Matrix3d limited = limitInertia(believed.body.inertia, model.body.inertia);
    if (limited != model.body.inertia) {
        notes.push_back("body.inertia is identified with the principal moments " + formatMoments(model.body.inertia) +
                        " kg m^2, which no body has; the fitted model holds " + formatMoments(limited) +
                        ", the way from the believed ones as far as bodies go");
        model.body.inertia = limited;
    }
    return notes;
}

}  // namespace wems
