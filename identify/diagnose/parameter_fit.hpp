/// @file
/// Gauss–Newton (Levenberg–Marquardt) fit of knobs to the whitened open-loop residual.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/diagnose/knob.hpp"
#include "identify/diagnose/open_loop_problem.hpp"

namespace wems::identify {

struct ParameterFit {
    MountModel model;            ///< with the fitted values
    std::vector<double> values;  ///< of the knobs
    Eigen::MatrixXd covariance;  ///< of the values, from unit noise, calibration scatter included
    double misfit = 0;           ///< for each value: about 1 for a perfect model
    WhiteVector residual;
    int iterations = 0;
};

/// Fits from the values that `start` has. Values stay in their physical range.
ParameterFit fitParameters(const OpenLoopProblem& problem, const MountModel& start, const std::vector<Knob>& knobs,
                           int max_iterations = 12);

}  // namespace wems::identify
