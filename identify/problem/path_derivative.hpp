/// @file
/// How what motion drags along, hysteresis, sliders and bristle (models/axis_law.hpp), answers to a small change of the
/// motion: the derivative of its force along a path.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "models/axis_law.hpp"

namespace wems::identify {

/// Each state follows its own path: s' = Φ(s, q0, v0, q1, v1) over an interval, so that a change of it is a recurrence
/// with the derivatives of Φ, formed once by differences.
class PathDerivative {
public:
    PathDerivative() = default;
    /// About this motion, which begins at rest.
    /// @param q, v displacement (m) and velocity (m/s) at the samples; @param interval s
    PathDerivative(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double interval);

    bool isZero() const { return states_.empty(); }
    /// Change of the force (N) at the samples.
    /// @param q, v changes of displacement (m) and velocity (m/s) at the samples
    Eigen::VectorXd apply(const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& v) const;

private:
    /// Of one state at one sample: of the state before, of the ends of the interval before, and of the force.
    struct Step {
        double kept = 0;
        std::array<double, 4> by_ends{};  ///< q0, v0, q1, v1
        double force = 0;                 ///< N/m
    };
    std::vector<std::vector<Step>> states_;
};

}  // namespace wems::identify
