#include "tests/hidden/outside_effect.hpp"

#include <cmath>

#include "models/common/units.hpp"

namespace wems::hidden {

double OutsideEffect::calcForce(const Eigen::Vector3d& q, double time) const {
    const double x = q[axis] / length;
    switch (kind) {
        case Kind::none:
            return 0;
        case Kind::periodic_stiffness:
            return size * q[axis] * std::sin(kTwoPi * frequency * time);
        case Kind::disturbance:
            return size * std::sin(kTwoPi * frequency * time);
        case Kind::cross_axis:
            return size * std::pow(q[other_axis] / length, 2);
        case Kind::buckling:
            return size * x * std::exp(0.5 - 0.5 * x * x);
    }
    return 0;
}

std::string formatKind(OutsideEffect::Kind kind) {
    constexpr const char* names[] = {"none", "periodic_stiffness", "disturbance", "cross_axis", "buckling"};
    return names[static_cast<int>(kind)];
}

OutsideEffect drawOutside(const MountModel& model, bool axis_only, Random& random) {
    OutsideEffect outside;
    using Kind = OutsideEffect::Kind;
    outside.kind = static_cast<Kind>(drawInteger(random, 1, 4));
    if (axis_only && outside.kind == Kind::cross_axis) outside.kind = Kind::buckling;
    outside.connection = drawInteger(random, 0, static_cast<int>(model.connections.size()) - 1);
    outside.axis = axis_only ? 2 : drawInteger(random, 0, 2);
    outside.other_axis = (outside.axis + drawInteger(random, 1, 2)) % 3;
    const auto& connection = model.connections[outside.connection];
    const double stiffness = connection.axis[outside.axis].stiffness;
    const double range = connection.axis[2].stops.front().clearance;
    outside.frequency = drawUniform(random, 2, 9);
    outside.length = range * drawUniform(random, 0.15, 0.4);
    outside.size = stiffness * drawUniform(random, 0.3, 0.7);
    if (outside.kind == Kind::disturbance) {
        outside.frequency = drawUniform(random, 12, 45);
        outside.size *= 0.15 * range;
    } else if (outside.kind == Kind::cross_axis) {
        outside.size *= 0.3 * range;
    } else if (outside.kind == Kind::buckling) {
        outside.size *= -outside.length;
    }
    return outside;
}

}  // namespace wems::hidden
