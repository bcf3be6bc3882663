/// @file
/// What a small change of the motion makes of an axis' force, sample by sample.
///
/// The mean over a run is in the covariance's A (DynamicStiffness); contact comes and goes about it. Friction and what
/// is dragged along are in no mean.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "identify/problem/band_limited_force.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/path_derivative.hpp"

namespace wems::identify {

class AxisTangent {
public:
    /// @param row of the axis in run.q: 3 connection + axis
    AxisTangent(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row);

    /// Change of the force, N, without what relaxes.
    /// @param q, v changes of displacement (m) and velocity (m/s) at the samples
    Eigen::VectorXd calcChange(const Eigen::Ref<const Eigen::VectorXd>& q,
                               const Eigen::Ref<const Eigen::VectorXd>& v) const;
    /// The same less what the mean stiffness and damping of calcDynamicStiffness make of it.
    Eigen::VectorXd calcBeyondMean(const Eigen::Ref<const Eigen::VectorXd>& q,
                                   const Eigen::Ref<const Eigen::VectorXd>& v) const;
    /// Whether that is anything at all.
    bool isBeyondMean() const { return is_beyond_mean_; }
    /// Of slow motion, in the mean over the run: N/m, N s/m.
    double meanStiffness() const { return spring_.mean() + stop_stiffness_; }
    double meanDamping() const { return damping_ + stop_damping_; }
    /// N/m, of what relaxes: Σ_b k_b iωτ / (1 + iωτ). Of slow motion it gives nothing.
    std::complex<double> calcRelaxing(double w) const;
    bool relaxes() const { return !branches_.empty(); }

private:
    Eigen::VectorXd calcOfPath(const Eigen::Ref<const Eigen::VectorXd>& q,
                               const Eigen::Ref<const Eigen::VectorXd>& v) const;

    Eigen::VectorXd spring_;  // static stiffness without stops at each sample, N/m
    double damping_;
    StopDerivative stops_;
    double stop_stiffness_, stop_damping_;  // in the mean
    PathDerivative path_;
    double sliding_force_ = 0;  // N
    SlidingDerivative sliding_;
    bool is_beyond_mean_;
    std::vector<MaxwellBranch> branches_;
};

}  // namespace wems::identify
