#include "identify/motion/rotation_rates.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace wems::identify {
namespace {

/// c1, c2 and their derivatives with respect to s = θ². Below s = 0.04 the series to s³ are exact to 1e-13.
struct Coefficients {
    double c1, c2, c1_slope, c2_slope;
};

Coefficients calcCoefficients(double s) {
    if (s < 0.04) {
        return {0.5 - s / 24 * (1 - s / 30 * (1 - s / 56)), 1.0 / 6 - s / 120 * (1 - s / 42 * (1 - s / 72)),
                -1.0 / 24 + s / 360 * (1 - s * 3 / 112 * (1 - s / 67.5)),
                -1.0 / 120 + s / 2520 * (1 - s / 48 * (1 - s / 82.5))};
    }
    const double angle = std::sqrt(s), sine = std::sin(angle), versine = 1 - std::cos(angle);
    return {versine / s, (angle - sine) / (s * angle), (angle * sine / 2 - versine) / (s * s),
            (versine - 3 * (angle - sine) / angle) / (2 * s * s)};
}

/// B⁻¹ b = b − θ × b / 2 + e θ × (θ × b), e = (1 − θ/2 cot θ/2)/θ².
Eigen::Vector3d solveLeftJacobian(const Eigen::Vector3d& theta, const Eigen::Vector3d& b) {
    const double s = theta.squaredNorm();
    const double half = std::sqrt(s) / 2;
    const double e = s < 1e-3 ? 1.0 / 12 + s / 720 + s * s / 30240 : (1 - half / std::tan(half)) / s;
    const Eigen::Vector3d u = theta.cross(b);
    return b - 0.5 * u + e * theta.cross(u);
}

/// B' θ' = c1' u + c2' θ × u + c2 θ' × u, u = θ × θ'.
Eigen::Vector3d calcBias(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot) {
    const Coefficients c = calcCoefficients(theta.squaredNorm());
    const double s_rate = 2 * theta.dot(theta_dot);
    const Eigen::Vector3d u = theta.cross(theta_dot);
    return c.c1_slope * s_rate * u + c.c2_slope * s_rate * theta.cross(u) + c.c2 * theta_dot.cross(u);
}

Eigen::Vector3d multiply(const Eigen::Vector3d& theta, const Eigen::Vector3d& b) {
    const Coefficients c = calcCoefficients(theta.squaredNorm());
    const Eigen::Vector3d u = theta.cross(b);
    return b + c.c1 * u + c.c2 * theta.cross(u);
}

}  // namespace

Eigen::Vector3d calcAngularVelocity(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot) {
    return multiply(theta, theta_dot);
}

Eigen::Vector3d calcAngularAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                        const Eigen::Vector3d& theta_dot_dot) {
    return multiply(theta, theta_dot_dot) + calcBias(theta, theta_dot);
}

Eigen::Vector3d calcVectorRate(const Eigen::Vector3d& theta, const Eigen::Vector3d& w) {
    return solveLeftJacobian(theta, w);
}

Eigen::Vector3d calcVectorAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                       const Eigen::Vector3d& alpha) {
    return solveLeftJacobian(theta, alpha - calcBias(theta, theta_dot));
}

}  // namespace wems::identify
