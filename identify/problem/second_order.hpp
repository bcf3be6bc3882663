/// @file
/// What an error of sensors makes of a motion beyond first order.
///
/// To first order in the motion, an error that all sensors of a part share (a gain, a shift, a turn, places stretched
/// along with gains) is another rigid motion, which other masses and positions explain. Only what is of second order
/// tells it from them: each sensor sits on a lever that turns with the part, as do the centre of gravity and the
/// connections. With x_j(t) what the part turns and is pushed by, and q⁽ᵏ⁾(t) the derivatives of a signal by which the
/// error moves it along direction i, what an output changes by beyond first order is
///
///     Σ c_ijk x_j(t) q⁽ᵏ⁾(t)
///
/// c the mixed second derivatives of the output at rest. The products are those of all errors with the same signals.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/run_noise.hpp"

namespace wems::identify {

/// One instant of a part's motion, and of forces that act on it.
struct TurningInstant {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d unmoved_R = Eigen::Matrix3d::Identity();  ///< R without what the error adds; p is what it adds
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d w = Eigen::Vector3d::Zero(), a = Eigen::Vector3d::Zero(), alpha = Eigen::Vector3d::Zero();
    Eigen::Matrix3d other_R = Eigen::Matrix3d::Identity();  ///< of the other part
    Eigen::Vector3d other_p = Eigen::Vector3d::Zero();      ///< of the other part, from this one without p
    Eigen::VectorXd forces;
};
using TurningOutputs = std::function<Eigen::VectorXd(const TurningInstant&)>;

/// What a part's motion makes of what the mobile part demands above what the laws give (12, mount_equation.hpp), with
/// the forces that turn with it (rows x samples).
struct TurningWrench {
    TurningOutputs outputs;
    Eigen::MatrixXd forces;
    /// Of modes' responses to six accelerations (samples x 6), what stands beyond those to the tapered ones (6 x bins):
    /// six rows for each mode. None where they move no bracket.
    std::function<Eigen::MatrixXcd(const Eigen::MatrixXd& accelerations, const Eigen::MatrixXcd& tapered)> modal_edges;
};

class SecondOrder {
public:
    /// Six signals (samples x 6), their first and their second derivatives.
    using Signals = std::array<Eigen::Matrix<double, Eigen::Dynamic, 6>, 3>;

    /// @param other part, whose motion the outputs meet too; @param forces rows x samples
    SecondOrder(const SmoothPart& part, const SmoothPart& other, const Eigen::MatrixXd& forces, const Signals& signals,
                const EquationSpectra& spectra, const TurningOutputs& outputs);

    /// Of a motion whose six coordinates (translation above rotation, m and rad) are C times the signals: outputs x
    /// bins, tapered.
    Eigen::MatrixXcf calc(const Matrix6& C) const;

private:
    std::vector<Eigen::MatrixXd> coefficients_;  // of each kind of product: outputs x 6 directions
    Eigen::MatrixXf products_;                   // spectra, a row for each kind and signal; real beside imaginary parts
};

}  // namespace wems::identify
