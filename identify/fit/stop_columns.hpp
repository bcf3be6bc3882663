/// @file
/// The columns of one stop in the equations of motion: few outputs are touched, so they are kept sparse.
#pragma once

#include <vector>

#include "identify/fit/equation_of_motion.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

/// Averages of a stop's force for 1 N/m and of its derivative to the clearance, at the outputs where they are not zero.
struct StopColumn {
    std::vector<int> output;                         ///< ascending
    Eigen::Matrix<double, 6, Eigen::Dynamic> value;  ///< one column for each of these outputs
    Eigen::Matrix<double, 6, Eigen::Dynamic> slope;  ///< ∂value/∂clearance, 1/m
    Vector6d value_mean = Vector6d::Zero();          ///< over all outputs of the run
    Vector6d slope_mean = Vector6d::Zero();
    double contact_share = 0;  ///< of all samples
};

/// @param history of the stop's axis; @param offset the law's; only `stop`'s side, clearance and dissipation count.
StopColumn makeStopColumn(const AxisHistory& history, const TestFunction& test_function, int outputs, const Stop& stop,
                          double offset);

/// Multiplies value and slope with `transform` (whitening).
void transform(StopColumn& column, const Matrix6d& transform);

/// Sums over all outputs of products, means removed.
struct StopProducts {
    double value_value = 0, value_slope = 0, slope_value = 0, slope_slope = 0;
};
StopProducts multiply(const StopColumn& a, const StopColumn& b, int outputs);

}  // namespace wems::identify
