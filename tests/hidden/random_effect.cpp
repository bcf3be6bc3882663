#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/parameter_access.hpp"
#include "tests/hidden/random_case.hpp"

namespace wems::hidden {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a result calls a parameter.
std::string reportName(const std::string& name) {
    if (name.rfind("body.", 0) == 0 || name.rfind("load.", 0) == 0) return name.substr(name.rfind('.') + 1);
    return name;
}

class Drawer {
public:
    Drawer(const std::string& cause, MountModel& base, MountModel& truth, Random& random)
        : base_(base), truth_(truth), random_(random) {
        effect_.cause = cause;
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
        effect_.parameters.emplace_back(reportName(name), value);
    }
    double uniform(double lower, double upper) { return drawUniform(random_, lower, upper); }
    double log(double lower, double upper) { return drawLog(random_, lower, upper); }
    bool coin(double probability) { return uniform(0, 1) < probability; }
    const Connection& drawConnection() {
        return truth_.connections[static_cast<std::size_t>(
            drawInteger(random_, 0, static_cast<int>(truth_.connections.size()) - 1))];
    }

    void drawBody() {
        effect_.where = {"body"};
        if (effect_.cause == "cog_offset") {
            const bool high_only = coin(0.5);
            for (const char* axis : {"x", "y", "z"}) {
                const std::string name = std::string("body.center_of_gravity.") + axis;
                if (*axis == 'z' || !high_only) set(name, now(name) + drawSign(random_) * log(0.004, 0.06));
            }
        } else if (effect_.cause == "mass") {
            set("body.mass", now("body.mass") * (1 + drawSign(random_) * log(0.02, 0.2)));
        } else if (effect_.cause == "inertia") {
            for (const char* name : {"Ixx", "Iyy", "Izz"}) {
                const std::string full = std::string("body.inertia.") + name;
                set(full, now(full) * uniform(1.05, 1.6));
            }
        } else {
            set("body.spin.z", drawSign(random_) * log(0.15, 3));
        }
    }

    /// One axis, or all of the axial or lateral ones.
    std::vector<std::string> drawAxes() {
        const std::string axis(1, coin(0.6) ? 'z' : coin(0.5) ? 'x' : 'y');
        if (!coin(0.3)) return {drawConnection().name + "." + axis};
        std::vector<std::string> axes;
        for (const auto& connection : truth_.connections) axes.push_back(connection.name + "." + axis);
        return axes;
    }

    void drawElastomer() {
        const std::string& cause = effect_.cause;
        effect_.where = drawAxes();
        const double one = uniform(0, 1), other = uniform(0, 1), sign = drawSign(random_);
        const auto between = [](double u, double lower, double upper) { return lower * std::pow(upper / lower, u); };
        for (const auto& axis : effect_.where) {
            if (cause == "elastomer_stiffness") {
                set(axis + ".stiffness", now(axis + ".stiffness") * (1 + sign * between(one, 0.05, 0.6)));
            } else if (cause == "viscous_damping") {
                set(axis + ".damping", now(axis + ".damping") * between(one, 1.5, 6));
            } else if (cause == "structural_damping") {
                set(axis + ".loss_factor", between(one, 0.03, 0.35));
            } else if (cause == "friction") {
                set(axis + ".friction_force", between(one, 1, 25));
                setParameter(truth_, axis + ".transition_velocity", between(other, 1e-3, 1e-2));
            } else if (cause == "cubic_stiffness") {
                const double range = base_.connections[0].axis[2].stops[0].clearance;
                set(axis + ".cubic", sign * between(one, 0.1, 0.7) * now(axis + ".stiffness") / (range * range));
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
                set(stop + ".stiffness", now(stop + ".stiffness") * (coin(0.5) ? uniform(0.2, 0.7) : uniform(1.5, 3)));
            } else if (coin(0.5)) {
                set(stop + ".clearance", clearance * (coin(0.5) ? uniform(0.5, 0.88) : uniform(1.12, 1.4)));
            } else if (coin(0.5)) {
                set(stop + ".clearance", kInfinity);
            } else {
                effect_.parameters = {{stop + ".clearance", clearance},
                                      {stop + ".stiffness", now(stop + ".stiffness")}};
                setParameter(base_, stop + ".clearance", kInfinity);
            }
        }
    }

    void drawSurroundings() {
        if (effect_.cause == "load") {
            effect_.where = {"load"};
            set("load.gain", 1 + drawSign(random_) * uniform(0.06, 0.25));
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
            set(mode + ".frequency", now(mode + ".frequency") * (1 + drawSign(random_) * log(0.015, 0.2)));
        } else {
            set(mode + ".damping_ratio", now(mode + ".damping_ratio") * uniform(2, 6));
        }
    }

    /// The modes file does not hold it; it would be the row after the last.
    void removeMode(int row) {
        const auto at = static_cast<std::ptrdiff_t>(row - 1);
        for (auto* model : {&base_, &truth_}) {
            auto& modes = model->bracket;
            std::rotate(modes.begin() + at, modes.begin() + at + 1, modes.end());
        }
        base_.bracket.pop_back();
        const std::string name = std::to_string(truth_.bracket.size());
        for (const char* parameter : {".frequency", ".damping_ratio"})
            effect_.parameters.emplace_back(name + parameter, now(name + parameter));
    }

    /// A channel, a triax, or a whole side. The quantity is added when the recording's channels are known.
    void drawSensor() {
        const std::string side = coin(0.7) ? "mobile" : "fixed";
        const std::string triax = side + "." + drawConnection().name;
        std::string place = triax;
        if (effect_.cause == "sensor_gain") {
            place = triax + "." + "xyz"[drawInteger(random_, 0, 2)];
            set(place + ".gain", 1 + drawSign(random_) * log(0.02, 0.2));
        } else if (effect_.cause == "sensor_delay") {
            const double which = uniform(0, 1);
            place = which < 0.5 ? triax + "." + "xyz"[drawInteger(random_, 0, 2)] : which < 0.75 ? triax : side;
            set(place + ".delay", log(3e-4, 3e-3));
        } else {
            const double angle = log(0.03, 0.2);
            Eigen::Vector3d axis(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            axis *= angle / axis.norm();
            for (int a = 0; a < 3; ++a) set(place + ".r" + "xyz"[a], axis[a]);
        }
        effect_.where = {place};
    }

    MountModel &base_, &truth_;
    Random& random_;
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

Effect drawEffect(const std::string& cause, MountModel& base, MountModel& truth, Random& random) {
    return Drawer(cause, base, truth, random).draw();
}

}  // namespace wems::hidden
