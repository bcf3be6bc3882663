#include "identify/problem/rigid_matrices.hpp"

#include <Eigen/Geometry>

#include "models/bryant.hpp"

namespace wems::identify {
namespace {

Matrix6 sumAxes(const MountModel& model, double AxisLaw::*coefficient) {
    Matrix6 sum = Matrix6::Zero();
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const Vector6 d = calcAxisDirection(model, static_cast<int>(i), a);
            sum += model.connections[i].axis[a].*coefficient * d * d.transpose();
        }
    return sum;
}

}  // namespace

Vector6 calcAxisDirection(const MountModel& model, int connection, int axis) {
    Vector6 d;
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(axis);
    d << e, model.connections[connection].position.cross(e);
    return d;
}

Matrix6 calcMassMatrix(const MobileBody& body) {
    const Eigen::Matrix3d C = crossMatrix(body.center_of_gravity);
    Matrix6 M;
    M << body.mass * Eigen::Matrix3d::Identity(), -body.mass * C, body.mass * C, body.inertia - body.mass * C * C;
    return M;
}

Vector6 calcFreedom(const MobileBody& body) {
    Vector6 freedom;
    for (std::size_t i = 0; i < body.free.size(); ++i) freedom[i] = body.free[i] ? 1 : 0;
    return freedom;
}

void holdMotions(Matrix6& matrix, const Vector6& freedom, double diagonal) {
    matrix = (freedom.asDiagonal() * matrix * freedom.asDiagonal()).eval();
    matrix.diagonal() += diagonal * (Vector6::Ones() - freedom);
}

Matrix6 calcStiffnessMatrix(const MountModel& model) {
    return sumAxes(model, &AxisLaw::stiffness);
}

Matrix6 calcDampingMatrix(const MountModel& model) {
    return sumAxes(model, &AxisLaw::damping);
}

}  // namespace wems::identify
