#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/parameter_access.hpp"
#include "tests/hidden/random_case.hpp"

namespace wems::hidden {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Drawer {
public:
    Drawer(const std::string& cause, MountModel& base, MountModel& truth, Random& random, int level,
           const SetUp& set_up)
        : base_(base),
          truth_(truth),
          random_(random),
          set_up_(set_up),
          level_(level),
          own_(makeSmallErrors(level)),
          largest_(makeSmallErrors(2)) {
        effect_.cause = cause;
        effect_.variant = "one";
    }

    Effect draw() {
        const std::string& cause = effect_.cause;
        if (cause == "cog_offset" || cause == "mass" || cause == "inertia" || cause == "gyroscopic") {
            drawBody();
        } else if (cause == "clearance" || cause == "stop_stiffness" || cause == "preload" ||
                   cause == "stop_dissipation") {
            drawStop();
        } else if (cause == "bracket_mode" || cause == "load") {
            drawSurroundings();
        } else if (cause.rfind("sensor_", 0) == 0) {
            drawSensor();
        } else {
            drawElastomer();
        }
        return effect_;
    }

private:
    double now(const std::string& name) const { return getParameter(truth_, name); }
    void set(const std::string& name, double value) {
        setParameter(truth_, name, value);
        effect_.names.push_back(name);
    }
    double uniform(double lower, double upper) { return drawUniform(random_, lower, upper); }
    double log(double lower, double upper) { return drawLog(random_, lower, upper); }
    bool coin(double probability) { return drawCoin(random_, probability); }
    /// Relative to the value, or in its unit; well beyond the tolerance where there is one.
    double departure(double SmallErrors::*tolerance, double lower, double upper) {
        return level_ == 0 ? log(lower, upper) : uniform(2.5 * own_.*tolerance, 8 * largest_.*tolerance);
    }
    const Connection& drawConnection() {
        return truth_.connections[drawInteger(random_, 0, static_cast<int>(truth_.connections.size()) - 1)];
    }

    void drawBody() {
        effect_.where = {"body"};
        if (effect_.cause == "cog_offset") {
            const bool high_only = coin(0.5);
            for (const char* axis : {"x", "y", "z"}) {
                const std::string name = std::string("body.center_of_gravity.") + axis;
                if (*axis == 'z' || !high_only)
                    set(name, now(name) + drawSign(random_) * departure(&SmallErrors::center_of_gravity, 0.004, 0.06));
            }
        } else if (effect_.cause == "mass") {
            set("body.mass", now("body.mass") * (1 + drawSign(random_) * departure(&SmallErrors::mass, 0.02, 0.2)));
        } else if (effect_.cause == "inertia") {
            for (const char* name : {"Ixx", "Iyy", "Izz"}) {
                const std::string full = std::string("body.inertia.") + name;
                set(full, now(full) * (1 + departure(&SmallErrors::inertia, 0.05, 0.6)));
            }
        } else {
            set("body.spin.z", drawSign(random_) * log(0.15, 3));
        }
    }

    /// One axis, or all of the axial or lateral ones.
    std::vector<std::string> drawAxes() {
        const std::string axis(1, set_up_.oneAxis() || coin(0.6) ? 'z' : coin(0.5) ? 'x' : 'y');
        if (!coin(0.3)) return {drawConnection().name + "." + axis};
        effect_.variant = "all_of_direction";
        std::vector<std::string> axes;
        for (const auto& connection : truth_.connections) axes.push_back(connection.name + "." + axis);
        return axes;
    }

    void drawElastomer() {
        const std::string& cause = effect_.cause;
        effect_.where = drawAxes();
        const double one = uniform(0, 1), other = uniform(0, 1), sign = drawSign(random_);
        const double stiffness = departure(&SmallErrors::stiffness, 0.05, 0.6);
        const double damping = departure(&SmallErrors::damping, 0.5, 5);
        const auto between = [](double u, double lower, double upper) { return lower * std::pow(upper / lower, u); };
        for (const auto& axis : effect_.where) {
            if (cause == "elastomer_stiffness") {
                set(axis + ".stiffness", now(axis + ".stiffness") * (1 + sign * stiffness));
            } else if (cause == "viscous_damping") {
                set(axis + ".damping", now(axis + ".damping") * (1 + damping));
            } else if (cause == "structural_damping") {
                set(axis + ".loss_factor", between(one, 0.03, 0.35));
            } else if (cause == "friction") {
                set(axis + ".friction_force", between(one, 1, 25));
                setParameter(truth_, axis + ".transition_velocity", between(other, 1e-3, 1e-2));
            } else if (cause == "cubic_stiffness") {
                const double range = base_.connections[0].axis[2].stops[0].clearance;
                set(axis + ".cubic", sign * between(one, 0.1, 0.7) * now(axis + ".stiffness") / (range * range));
            } else if (cause == "asymmetric_stiffness") {
                const double range = base_.connections[0].axis[2].stops[0].clearance;
                set(axis + ".quadratic", sign * between(one, 0.1, 0.6) * now(axis + ".stiffness") / range);
            } else if (cause == "hysteresis") {
                // Slides within the travel: a force of up to a third of the elastomer's.
                const double range = base_.connections[0].axis[2].stops[0].clearance;
                set(axis + ".hysteresis_force", between(one, 0.03, 0.3) * now(axis + ".stiffness") * range);
                set(axis + ".yield_displacement", between(other, 0.05, 0.5) * range);
            } else if (cause == "relaxation") {
                set(axis + ".stiffness_ratio", between(one, 0.1, 0.7));
                set(axis + ".time_constant", between(other, 2e-3, 0.03));
            } else if (cause == "stiffness_drift") {
                set(axis + ".drift", sign * between(one, 0.003, 0.03));
            } else {
                throw std::logic_error("no size is drawn for an effect of " + cause);
            }
        }
    }

    void drawStop() {
        const std::string& cause = effect_.cause;
        const auto& connection = drawConnection();
        const std::string axis = connection.name + ".z";
        const double clearance = connection.axis[2].stops[0].clearance;
        effect_.where = {axis};
        if (cause == "preload") {
            set(axis + ".offset", drawSign(random_) * uniform(0.12, 0.4) * clearance);
        } else if (cause == "stop_dissipation") {
            if (coin(0.5)) {
                effect_.where.clear();
                for (const auto& each : truth_.connections) effect_.where.push_back(each.name + ".z");
            }
            const double value = log(0.3, 3);
            for (const auto& place : effect_.where) set(place + ".dissipation", value);
        } else {
            const std::string stop = axis + (coin(0.5) ? ".+" : ".-");
            effect_.where = {stop};
            if (cause == "stop_stiffness") {
                const double size = departure(&SmallErrors::stop_stiffness, 0.3, 2);
                set(stop + ".stiffness", now(stop + ".stiffness") * (coin(0.5) ? 1 / (1 + size) : 1 + size));
            } else {
                drawClearance(axis, stop, clearance);
            }
        }
    }

    /// One stop's clearance, both of an axis, all of the axial ones by one factor, a stop too many, one that is
    /// missing.
    void drawClearance(const std::string& axis, const std::string& stop, double clearance) {
        const auto factor = [&] {
            const double size = departure(&SmallErrors::clearance, 0.1, 0.5);
            return coin(0.5) ? 1 / (1 + size) : 1 + size;
        };
        const double which = uniform(0, 1);
        if (which < 0.3) {
            set(stop + ".clearance", clearance * factor());
        } else if (which < 0.5) {
            effect_.variant = "both_sides";
            effect_.where = {axis + ".+", axis + ".-"};
            for (const auto& place : effect_.where) set(place + ".clearance", clearance * factor());
        } else if (which < 0.65) {
            effect_.variant = "all_of_direction";
            effect_.where.clear();
            const double one = factor();
            for (const auto& connection : truth_.connections)
                for (const char* side : {".z.+", ".z.-"}) effect_.where.push_back(connection.name + side);
            for (const auto& place : effect_.where) set(place + ".clearance", now(place + ".clearance") * one);
        } else if (which < 0.83) {
            effect_.variant = "too_many";
            set(stop + ".clearance", kInfinity);
        } else {
            effect_.variant = "missing";
            effect_.names = {stop + ".clearance", stop + ".stiffness"};
            setParameter(base_, stop + ".clearance", kInfinity);
        }
    }

    void drawSurroundings() {
        if (effect_.cause == "load") {
            effect_.where = {"load"};
            if (set_up_.kind == SetUp::Kind::bracket && coin(0.4)) {
                effect_.variant = "drop_out";
                const double at = log(1.4 * kLowest, 0.7 * kHighest), half = at * uniform(0.1, 0.3);
                truth_.load = LoadCorrection{
                    {{kLowest, 1.0}, {at - half, 1.0}, {at, uniform(0.2, 0.7)}, {at + half, 1.0}, {kHighest, 1.0}}};
            } else {
                set("load.gain", 1 + drawSign(random_) * uniform(0.06, 0.25));
            }
            return;
        }
        effect_.where = {"bracket"};
        const int row = drawInteger(random_, 1, static_cast<int>(truth_.bracket.size()));
        if (coin(0.3)) {
            removeMode(row);
            return;
        }
        const std::string mode = std::to_string(row);
        if (coin(0.65)) {
            set(mode + ".frequency", now(mode + ".frequency") *
                                         (1 + drawSign(random_) * departure(&SmallErrors::mode_frequency, 0.015, 0.2)));
        } else {
            set(mode + ".damping_ratio",
                now(mode + ".damping_ratio") * (1 + departure(&SmallErrors::mode_damping_ratio, 1, 5)));
        }
    }

    /// The modes file does not hold it; it would be the row after the last.
    void removeMode(int row) {
        const std::ptrdiff_t at = row - 1;
        for (auto* model : {&base_, &truth_}) {
            auto& modes = model->bracket;
            std::rotate(modes.begin() + at, modes.begin() + at + 1, modes.end());
        }
        base_.bracket.pop_back();
        effect_.variant = "missing";
        const std::string name = std::to_string(truth_.bracket.size());
        for (const char* parameter : {".frequency", ".damping_ratio"}) effect_.names.push_back(name + parameter);
    }

    /// A channel, a triax, or a whole side. The quantity is added when the recording's channels are known.
    void drawSensor() {
        const std::string side = !set_up_.records_fixed || coin(0.7) ? "mobile" : "fixed";
        // A one-axis rig has its sensors at the first connection.
        const std::string triax = side + "." + (set_up_.oneAxis() ? base_.connections.front() : drawConnection()).name;
        std::string place = triax;
        if (effect_.cause == "sensor_gain") {
            place = triax + "." + drawAxis();
            set(place + ".gain", 1 + drawSign(random_) * departure(&SmallErrors::sensor_gain, 0.02, 0.2));
        } else if (effect_.cause == "sensor_delay") {
            const double which = uniform(0, 1);
            place = which < 0.5 ? triax + "." + drawAxis() : which < 0.75 ? triax : side;
            set(place + ".delay", log(3e-4, 3e-3));
        } else {
            const double angle = departure(&SmallErrors::sensor_rotation, 0.03, 0.2);
            Eigen::Vector3d axis(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            axis *= angle / axis.norm();
            for (int a = 0; a < 3; ++a) set(place + ".r" + "xyz"[a], axis[a]);
        }
        effect_.where = {place};
    }
    char drawAxis() { return set_up_.oneAxis() ? 'z' : "xyz"[drawInteger(random_, 0, 2)]; }

    MountModel &base_, &truth_;
    Random& random_;
    const SetUp& set_up_;
    int level_;
    SmallErrors own_, largest_;
    Effect effect_;
};

}  // namespace

const std::vector<std::string>& listCauses() {
    static const std::vector<std::string> causes{"cog_offset",
                                                 "mass",
                                                 "inertia",
                                                 "elastomer_stiffness",
                                                 "stop_stiffness",
                                                 "clearance",
                                                 "preload",
                                                 "viscous_damping",
                                                 "structural_damping",
                                                 "friction",
                                                 "stop_dissipation",
                                                 "hysteresis",
                                                 "asymmetric_stiffness",
                                                 "cubic_stiffness",
                                                 "relaxation",
                                                 "stiffness_drift",
                                                 "gyroscopic",
                                                 "sensor_delay",
                                                 "sensor_gain",
                                                 "sensor_misalignment",
                                                 "bracket_mode",
                                                 "load"};
    return causes;
}

std::vector<std::string> listCauses(const SetUp& set_up) {
    std::vector<std::string> possible;
    for (const auto& cause : listCauses()) {
        if (cause == "bracket_mode" && set_up.kind != SetUp::Kind::bracket) continue;
        if (cause == "load" && !set_up.loaded()) continue;
        if (set_up.oneAxis() &&
            (cause == "cog_offset" || cause == "inertia" || cause == "gyroscopic" || cause == "sensor_misalignment"))
            continue;
        possible.push_back(cause);
    }
    return possible;
}

Effect drawEffect(const std::string& cause, MountModel& base, MountModel& truth, Random& random, int level,
                  const SetUp& set_up) {
    return Drawer(cause, base, truth, random, level, set_up).draw();
}

}  // namespace wems::hidden
