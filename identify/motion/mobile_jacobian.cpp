#include "identify/motion/mobile_jacobian.hpp"

#include "models/bryant.hpp"

namespace wems::identify {

MobileJacobian::MobileJacobian(const Eigen::Matrix3Xd& ends, const Eigen::Vector3d& center_of_gravity)
    : arms_(ends.colwise() - center_of_gravity) {}

Eigen::Matrix3Xd MobileJacobian::calcPositions(const Coordinates& q) const {
    return (rotationFromBryant(q.tail<3>()) * arms_).colwise() + q.head<3>();
}

Eigen::Matrix<double, Eigen::Dynamic, 6> MobileJacobian::calcVelocityJacobian(const Coordinates& q) const {
    const Eigen::Matrix3Xd arms = rotationFromBryant(q.tail<3>()) * arms_;
    Eigen::Matrix<double, Eigen::Dynamic, 6> J(3 * arms.cols(), 6);
    for (Eigen::Index i = 0; i < arms.cols(); ++i) {
        J.block<3, 3>(3 * i, 0).setIdentity();
        J.block<3, 3>(3 * i, 3) = -crossMatrix(arms.col(i));
    }
    return J;
}

Eigen::Matrix<double, Eigen::Dynamic, 6> MobileJacobian::calcJacobian(const Coordinates& q) const {
    Eigen::Matrix<double, Eigen::Dynamic, 6> J = calcVelocityJacobian(q);
    J.rightCols<3>() = (J.rightCols<3>() * bryantRatesToAngularVelocity(q.tail<3>())).eval();
    return J;
}

Coordinates MobileJacobian::calcWrench(const Coordinates& q, const Coordinates& generalized_forces) const {
    Coordinates wrench = generalized_forces;
    wrench.tail<3>() = angularVelocityToBryantRates(q.tail<3>()).transpose() * generalized_forces.tail<3>();
    return wrench;
}

}  // namespace wems::identify
