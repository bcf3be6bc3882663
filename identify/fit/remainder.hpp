/// @file
/// What the fitted equations of motion leave of each run.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/mount_model.hpp"

namespace wems::identify {

class Solver;

/// Column n is output n of the equations, averaged with their test function; rows: force x y z (N), moment about Mo
/// x y z (N m), in G, each less its mean over the run.
struct RunRemainder {
    double start = 0, interval = 0;                        ///< s, of the outputs, in the run's own time
    double overlap = 0;                                    ///< s, outputs nearer than this have samples in common
    Eigen::Matrix<double, 6, Eigen::Dynamic> demanded;     ///< wrench that the motion demands of the mount
    Eigen::Matrix<double, 6, Eigen::Dynamic> unexplained;  ///< what the fitted laws leave of it
};

std::vector<RunRemainder> calcRemainders(const Solver& solver);

/// RMS of the unexplained wrench over that of the demanded one, all runs together, moments over the mount's mean arm; 0
/// if nothing is demanded.
double calcUnexplainedFraction(const std::vector<RunRemainder>& runs, const MountModel& model);

/// Of a series: Σ r_n r_{n+k} / Σ r_n² for k = 0 … lags; zeros for a series of zeros.
Eigen::VectorXd calcAutocorrelation(const Eigen::VectorXd& series, int lags);

/// Bartlett's 95 % limit for the autocorrelation of `count` samples at lags where it is zero, given what it is at the
/// lags before (element 0 is lag 0): 1.96 √((1 + 2 Σ ρ_k²) / count). Box, Jenkins, Reinsel (2008), eq. (2.1.15).
double calcAutocorrelationLimit(const Eigen::VectorXd& before, Eigen::Index count);

}  // namespace wems::identify
