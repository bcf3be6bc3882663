#include "tests/hidden/small_errors.hpp"

#include <array>
#include <utility>

#include "models/format_number.hpp"

namespace wems::hidden {
namespace {

std::array<std::pair<const char*, double Tolerances::*>, 16> listKeys() {
    return {{{"mass", &Tolerances::mass},
             {"center_of_gravity", &Tolerances::center_of_gravity},
             {"inertia", &Tolerances::inertia},
             {"stiffness", &Tolerances::stiffness},
             {"damping", &Tolerances::damping},
             {"clearance", &Tolerances::clearance},
             {"stop_stiffness", &Tolerances::stop_stiffness},
             {"position", &Tolerances::position},
             {"mode_frequency", &Tolerances::mode_frequency},
             {"mode_damping_ratio", &Tolerances::mode_damping_ratio},
             {"mode_shape", &Tolerances::mode_shape},
             {"load_gain", &Tolerances::load_gain},
             {"sensor_gain", &Tolerances::sensor_gain},
             {"sensor_rotation", &Tolerances::sensor_rotation},
             {"sensor_position", &Tolerances::sensor_position},
             {"sensor_delay", &Tolerances::sensor_delay}}};
}

}  // namespace

Tolerances makeTolerances(int level) {
    Tolerances tolerances;
    tolerances.share = 0.5 * level;
    for (const auto& [key, member] : listKeys()) tolerances.*member *= tolerances.share;
    tolerances.load_noise *= tolerances.share;
    return tolerances;
}

MountModel drawBelieved(const MountModel& exact, const Tolerances& tolerances, Random& random) {
    MountModel model = exact;
    const auto within = [&](double tolerance) { return drawUniform(random, -1, 1) * tolerance; };
    const auto shift = [&](Eigen::Vector3d& vector, double tolerance) {
        for (double& value : vector) value += within(tolerance);
    };
    const auto scale = [&](double& value, double tolerance) { value *= 1 + within(tolerance); };
    const auto scaleShape = [&](Eigen::Vector3d& shape) {
        for (double& value : shape) scale(value, tolerances.mode_shape);
    };
    scale(model.body.mass, tolerances.mass);
    shift(model.body.center_of_gravity, tolerances.center_of_gravity);
    for (int a = 0; a < 3; ++a) scale(model.body.inertia(a, a), tolerances.inertia);
    for (auto& connection : model.connections) {
        shift(connection.position, tolerances.position);
        for (auto& law : connection.axis) {
            scale(law.stiffness, tolerances.stiffness);
            scale(law.damping, tolerances.damping);
            for (auto& stop : law.stops) {
                scale(stop.clearance, tolerances.clearance);
                scale(stop.stiffness, tolerances.stop_stiffness);
            }
        }
    }
    for (auto& mode : model.bracket) {
        scale(mode.frequency, tolerances.mode_frequency);
        scale(mode.damping_ratio, tolerances.mode_damping_ratio);
        scaleShape(mode.translation);
        scaleShape(mode.rotation);
        scaleShape(mode.load_translation);
    }
    return model;
}

std::string formatTolerances(const Tolerances& tolerances, double time_scale) {
    std::string text = "\n[tolerance]\n";
    for (const auto& [key, member] : listKeys()) {
        const bool time = member == &Tolerances::sensor_delay;
        text += std::string(key) + " = " + formatNumber(tolerances.*member * (time ? time_scale : 1.0)) + "\n";
    }
    return text;
}

}  // namespace wems::hidden
