/// @file
/// What small motion about a measured one meets of a law: its equivalent linear stiffness, and how that comes and goes.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "identify/problem/open_loop_run.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

/// In the mean over a run: κ(ω) = k + iωc − Σ_b k_b / (1 + iωτ_b), k with the branches' springs at work and the stops
/// as long as they touch. Dry friction is left out: the equations take a velocity without noise for it.
struct DynamicStiffness {
    double stiffness = 0;  ///< N/m
    double damping = 0;    ///< N s/m
    std::vector<MaxwellBranch> branches;

    std::complex<double> at(double w) const;
};

/// @param row of the axis in q and v: 3 connection + axis
DynamicStiffness calcDynamicStiffness(const OpenLoopRun& run, AxisLaw law, Eigen::Index row);

/// Static stiffness along the run beyond its mean, N/m: zero where no stop touches and the law is linear.
Eigen::RowVectorXd calcStiffnessFluctuation(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row);

}  // namespace wems::identify
