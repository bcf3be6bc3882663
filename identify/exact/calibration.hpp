/// @file
/// What a small gain error of one channel, or of the load, does to the open-loop residuals, to first order.
///
/// A gain error of channel c (displacement s_c along its axis) moves the rigid fit by P_c s_c, P_c the c-th column of
/// the fit's pseudo-inverse at rest. Demand, laws (through their tangent stiffness) and prediction follow linearly.
#pragma once

#include <Eigen/Core>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/open_loop_run.hpp"

namespace wems::identify {

class CalibrationResponse {
public:
    /// @param bracket nullptr if its equation is not used
    CalibrationResponse(const OpenLoopRun& run, const MountModel& model, const BracketEquation* bracket);

    /// Change of both residuals (6 x samples, empty if none) for a unit error. Columns: 3 i + a of the mobile side,
    /// then the same of the fixed side, then the load's x, y, z.
    void calc(Eigen::Index column, Eigen::MatrixXd& mount, Eigen::MatrixXd& bracket) const;

    /// Change of both residuals for a unit of a fault that all displacement channels of a side share.
    /// @param number 0 gain (measured = gain · true), 1 delay (s), 2 … 4 rotation about x, y, z (rad)
    void calcSide(bool mobile, int number, Eigen::MatrixXd& mount, Eigen::MatrixXd& bracket) const;

private:
    /// Response to a change of a part's motion (translation above rotation) and its two derivatives.
    void calcChange(bool mobile, const Eigen::MatrixXd& motion, const Eigen::MatrixXd& rate,
                    const Eigen::MatrixXd& acceleration, Eigen::MatrixXd& mount, Eigen::MatrixXd& bracket) const;
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    void calcChannel(bool mobile, const Vector6& direction, Eigen::MatrixXd& mount, Eigen::MatrixXd& bracket) const;

    const OpenLoopRun* run_;
    const MountModel* model_;
    const BracketEquation* bracket_;
    Eigen::Matrix<double, 6, 6> mass_, covariance_;
    Eigen::MatrixXd tangent_;            // axes x samples, N/m
    Eigen::Matrix<double, 6, -1> axes_;  // directions
    Eigen::VectorXd damping_;
};

}  // namespace wems::identify
