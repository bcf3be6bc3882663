#include "models/bryant.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

namespace wems {
namespace {

/// a = (1 − cos φ)/φ², b = (φ − sin φ)/φ³. Power series where the closed forms lose digits to cancellation.
struct JacobianCoefficients {
    double a, b;
};

JacobianCoefficients calcCoefficients(double phi_squared) {
    const double s = phi_squared;
    if (s < 0.09) {  // the first term left out is below 2e-14 of the sum; reciprocals, as divisions are slow
        return {0.5 - s * (1.0 / 24) * (1 - s * (1.0 / 30) * (1 - s * (1.0 / 56) * (1 - s * (1.0 / 90)))),
                1.0 / 6 - s * (1.0 / 120) * (1 - s * (1.0 / 42) * (1 - s * (1.0 / 72) * (1 - s * (1.0 / 110))))};
    }
    const double phi = std::sqrt(s);
    const double half = std::sin(phi / 2);
    return {2 * half * half / s, (phi - std::sin(phi)) / (s * phi)};
}

/// Derivatives of a and b by φ, each over φ.
JacobianCoefficients calcCoefficientRates(double phi_squared) {
    const double s = phi_squared;
    if (s < 0.09) {  // as above
        return {-1.0 / 12 + s / 180 * (1 - 3 * s / 112 * (1 - 2 * s / 135 * (1 - 5 * s / 528))),
                -1.0 / 60 + s / 1260 * (1 - s / 48 * (1 - 2 * s / 165 * (1 - 5 * s / 624)))};
    }
    const double phi = std::sqrt(s);
    const double sine = std::sin(phi);
    const double half = std::sin(phi / 2);
    const double versine = 2 * half * half;
    return {(phi * sine - 2 * versine) / (s * s), (versine * phi - 3 * (phi - sine)) / (s * s * phi)};
}

[[noreturn]] void throwSingular() {
    throw std::domain_error(
        "Bryant angles: beta is ±pi/2, where alpha and gamma turn about the same axis and are not "
        "determined one by one");
}

// Below this cosine of beta, alpha and gamma would lose more than half of their digits.
constexpr double smallest_cosine = 1e-8;

}  // namespace

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& v) {
    const double s = v.squaredNorm();
    const double phi = std::sqrt(s);
    const double sine_over_phi = s < 1e-8 ? 1 - s / 6 : std::sin(phi) / phi;
    const Eigen::Matrix3d K = crossMatrix(v);
    return Eigen::Matrix3d::Identity() + sine_over_phi * K + calcCoefficients(s).a * (K * K);
}

Eigen::Vector3d vectorFromRotation(const Eigen::Matrix3d& R) {
    // By way of the quaternion: well conditioned at 0 and at π alike.
    Eigen::Quaterniond quaternion(R);
    quaternion.normalize();
    if (quaternion.w() < 0) quaternion.coeffs() = -quaternion.coeffs();
    const double sine = quaternion.vec().norm();
    if (sine < 1e-12) return 2 * quaternion.vec();
    return (2 * std::atan2(sine, quaternion.w()) / sine) * quaternion.vec();
}

Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& v) {
    const JacobianCoefficients c = calcCoefficients(v.squaredNorm());
    const Eigen::Matrix3d K = crossMatrix(v);
    return Eigen::Matrix3d::Identity() + c.a * K + c.b * (K * K);
}

Eigen::Matrix3d leftJacobianRate(const Eigen::Vector3d& v, const Eigen::Vector3d& v_dot) {
    const JacobianCoefficients c = calcCoefficients(v.squaredNorm());
    const JacobianCoefficients c_rate = calcCoefficientRates(v.squaredNorm());
    const double rate = v.dot(v_dot);  // φ φ'
    const Eigen::Matrix3d K = crossMatrix(v), K_dot = crossMatrix(v_dot);
    return c_rate.a * rate * K + c.a * K_dot + c_rate.b * rate * (K * K) + c.b * (K_dot * K + K * K_dot);
}

Eigen::Matrix3d rotationFromBryant(const Eigen::Vector3d& angles) {
    return (Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()))
        .toRotationMatrix();
}

Eigen::Vector3d bryantFromRotation(const Eigen::Matrix3d& R) {
    const double cosine = std::hypot(R(0, 0), R(0, 1));
    if (cosine < smallest_cosine) throwSingular();
    return {std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), cosine), std::atan2(-R(0, 1), R(0, 0))};
}

Eigen::Matrix3d bryantRatesToAngularVelocity(const Eigen::Vector3d& angles) {
    const double sa = std::sin(angles.x()), ca = std::cos(angles.x());
    const double sb = std::sin(angles.y()), cb = std::cos(angles.y());
    Eigen::Matrix3d N;  // columns: x of G, y after α, z of M
    N << 1, 0, sb, 0, ca, -sa * cb, 0, sa, ca * cb;
    return N;
}

Eigen::Matrix3d angularVelocityToBryantRates(const Eigen::Vector3d& angles) {
    const double sa = std::sin(angles.x()), ca = std::cos(angles.x());
    const double sb = std::sin(angles.y()), cb = std::cos(angles.y());
    if (std::abs(cb) < smallest_cosine) throwSingular();
    Eigen::Matrix3d N_inverse;
    N_inverse << 1, sa * sb / cb, -ca * sb / cb, 0, ca, sa, 0, -sa / cb, ca / cb;
    return N_inverse;
}

}  // namespace wems
