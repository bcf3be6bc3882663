#include "tests/hidden/small_errors.hpp"

#include <array>
#include <utility>

namespace wems::hidden {
namespace {

using Of = ToleranceOf;
constexpr std::array<std::pair<Of, double SmallErrors::*>, 16> kMembers{
    {{Of::mass, &SmallErrors::mass},
     {Of::center_of_gravity, &SmallErrors::center_of_gravity},
     {Of::inertia, &SmallErrors::inertia},
     {Of::stiffness, &SmallErrors::stiffness},
     {Of::damping, &SmallErrors::damping},
     {Of::clearance, &SmallErrors::clearance},
     {Of::stop_stiffness, &SmallErrors::stop_stiffness},
     {Of::position, &SmallErrors::position},
     {Of::mode_frequency, &SmallErrors::mode_frequency},
     {Of::mode_damping_ratio, &SmallErrors::mode_damping_ratio},
     {Of::mode_shape, &SmallErrors::mode_shape},
     {Of::load_gain, &SmallErrors::load_gain},
     {Of::sensor_gain, &SmallErrors::sensor_gain},
     {Of::sensor_rotation, &SmallErrors::sensor_rotation},
     {Of::sensor_position, &SmallErrors::sensor_position},
     {Of::sensor_delay, &SmallErrors::sensor_delay}}};

}  // namespace

SmallErrors makeSmallErrors(int level) {
    SmallErrors errors;
    errors.share = 0.5 * level;
    for (const auto& [what, member] : kMembers) errors.*member *= errors.share;
    errors.load_noise *= errors.share;
    return errors;
}

MountModel drawBelieved(const MountModel& exact, const SmallErrors& errors, Random& random) {
    MountModel model = exact;
    const auto within = [&](double tolerance) { return drawUniform(random, -1, 1) * tolerance; };
    const auto shift = [&](Eigen::Vector3d& vector, double tolerance) {
        for (double& value : vector) value += within(tolerance);
    };
    const auto scale = [&](double& value, double tolerance) { value *= 1 + within(tolerance); };
    const auto scaleShape = [&](Eigen::Vector3d& shape) {
        for (double& value : shape) scale(value, errors.mode_shape);
    };
    scale(model.body.mass, errors.mass);
    shift(model.body.center_of_gravity, errors.center_of_gravity);
    for (int a = 0; a < 3; ++a) scale(model.body.inertia(a, a), errors.inertia);
    for (auto& connection : model.connections) {
        shift(connection.position, errors.position);
        for (auto& law : connection.axis) {
            scale(law.stiffness, errors.stiffness);
            scale(law.damping, errors.damping);
            for (auto& stop : law.stops) {
                scale(stop.clearance, errors.clearance);
                scale(stop.stiffness, errors.stop_stiffness);
            }
        }
    }
    for (auto& mode : model.bracket) {
        scale(mode.frequency, errors.mode_frequency);
        scale(mode.damping_ratio, errors.mode_damping_ratio);
        scaleShape(mode.translation);
        scaleShape(mode.rotation);
        scaleShape(mode.load_translation);
    }
    return model;
}

Tolerances stateTolerances(const SmallErrors& errors, double time_scale) {
    Tolerances tolerances;
    for (const auto& [what, member] : kMembers)
        tolerances.set(what, errors.*member * (what == Of::sensor_delay ? time_scale : 1.0));
    return tolerances;
}

}  // namespace wems::hidden
