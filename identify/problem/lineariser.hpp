/// @file
/// One run's equations at a state: whitened residual, and the columns that each number of the model makes of it.
///
/// Rows of the mount's equation (6) stand above those of the bracket's (6), bins beside each other; white means times
/// the whitener of run_noise.hpp.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/linearised_run.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/run_noise.hpp"

namespace wems::identify {

/// Everything about a run at a state that residual and columns share.
class Lineariser {
public:
    /// @param noise null: that of the state
    Lineariser(const TestRun& test, const SensorLayout& layout, const TestState& state,
               std::shared_ptr<const RunNoise> noise);

    /// What the columns need beyond the residual.
    void prepareColumns();

    const EquationSpectra& spectra() const { return spectra_; }
    const OpenLoopRun& run() const { return open_; }
    bool hasBracket() const { return with_bracket_; }
    const std::shared_ptr<const RunNoise>& noise() const { return noise_; }

    /// Whitened residual: 12 x bins, mount above bracket.
    const Eigen::MatrixXcd& residual() const { return white_; }

    Eigen::MatrixXcd whiten(const Eigen::MatrixXcd& mount, const Eigen::MatrixXcd& bracket) const;

    /// Spectra of a wrench of the mount's equation, the slow motion following it.
    Eigen::MatrixXcd transformMount(const Eigen::MatrixXd& wrench) const;

    /// Whitened: the force's spectrum along the whitened direction of its axis.
    /// @param[out] burst what noise of the displacement in contact makes of the column's product with the residual
    Eigen::MatrixXcd calcLawColumn(const TestState& from, const TestState& to, int connection, int axis, double step,
                                   Eigen::VectorXd& burst) const;

    /// The noise's covariance spreads evenly what a stop's stiffness makes of the displacement's noise; it comes in the
    /// instants of contact, where the columns of that stop have all they have. At each of those instants: the column's
    /// weight there times the deviation of the noise beyond the even one.
    Eigen::VectorXd calcBurst(const Eigen::VectorXcd& spectrum, std::size_t row) const;

    /// A change dM of the mass matrix, or of the spin.
    void calcBodyColumn(const TestState& to, double step, Eigen::MatrixXcd& mount, Eigen::MatrixXcd& bracket) const;

    /// The connection's laws act where it is: relative displacement and lever both move.
    Eigen::MatrixXcd calcPositionColumn(int connection, int axis) const;

    Eigen::MatrixXcd calcModeColumn(int mode, int which) const;

    Eigen::MatrixXcd calcShapeColumn(int mode, int entry) const;

    /// What the load at the bracket (or on the mobile part) with spectra `load` (3 x bins) adds.
    void calcLoadColumn(const Eigen::MatrixXcd& load, Eigen::MatrixXcd& bracket) const;
    Eigen::MatrixXcd calcLoadSpectra() const { return inputs_.middleRows(6, 3); }
    /// @param[out] share of the run's time that the hat covers
    Eigen::MatrixXcd calcHatSpectra(const LoadHat& hat, double& share) const;

    /// Response of a mode that was moving when the recording began: cosine and sine of its free decay.
    Eigen::MatrixXcd calcTransient(int mode, bool sine) const;

    /// A motion of one part that a sensor's error makes: its series (6 x samples) and spectra. @return whitened
    Eigen::MatrixXcd calcMotionColumn(Part part, const Eigen::MatrixXd& series, const Eigen::MatrixXcd& spectra) const;

    bool inContact() const { return in_contact_; }
    const MotionNoise& motionNoise() const { return motion_noise_; }

    Eigen::MatrixXcd whitenDirection(const Vector6& d) const;

    /// Share of the mount residual's power that lies within contact, tapered.
    double calcContactShare() const;

private:
    OpenLoopRun makeRun() const;

    void calcResiduals();

    const TestRun& test_;
    const MountModel& model_;
    OpenLoopRun open_;
    std::unique_ptr<SlowBalance> slow_;
    bool with_bracket_;
    EquationSpectra spectra_;
    MotionNoise motion_noise_;
    std::shared_ptr<const RunNoise> noise_;
    BracketEquation bracket_;
    Matrix6 K_, C_, M_;
    Eigen::MatrixXd demand_, mount_series_, forces_, tangent_;
    Eigen::VectorXd rest_tangent_;
    std::vector<char> touched_;
    bool in_contact_ = false;
    std::vector<Eigen::MatrixXcd> axis_white_;
    Eigen::MatrixXcd inputs_, white_;
};

}  // namespace wems::identify
