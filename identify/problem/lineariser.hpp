/// @file
/// One run's equations at a state: whitened residual, and the columns that each number of the model makes of it.
///
/// Rows of the mount's equation (6) stand above those of the bracket's (6), bins beside each other; white means times
/// the whitener of run_noise.hpp.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "identify/problem/axis_tangent.hpp"
#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/linearised_run.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/run_noise.hpp"
#include "identify/problem/sensor_columns.hpp"

namespace wems::identify {

/// Everything about a run at a state that residual and columns share.
class Lineariser {
public:
    /// @param test must outlive this
    Lineariser(const TestRun& test, const SensorLayout& layout, const TestState& state);
    Lineariser(const Lineariser&) = delete;  // its parts point at each other
    Lineariser& operator=(const Lineariser&) = delete;

    const EquationSpectra& spectra() const { return spectra_; }
    const OpenLoopRun& run() const { return open_; }
    bool hasBracket() const { return with_bracket_; }
    const RunNoise& noise() const { return noise_; }

    /// Whitened residual: 12 x bins, mount above bracket.
    const Eigen::MatrixXcd& residual() const { return white_; }

    /// What the columns need beyond the residual: before any of them.
    void prepareColumns();

    Eigen::MatrixXcd whiten(const Eigen::MatrixXcd& mount, const Eigen::MatrixXcd& bracket) const;

    /// Spectra of a wrench of the mount's equation, the slow motion following it.
    Eigen::MatrixXcd transformMount(const Eigen::MatrixXd& wrench) const;

    /// Whitened. The force turns with the parts, as in the residual: where it is large, what it has across the axis at
    /// rest is far above the noise.
    Eigen::MatrixXcd calcLawColumn(const TestState& from, const TestState& to, int connection, int axis,
                                   double step) const;

    /// The noise's covariance spreads evenly what a stop's stiffness makes of the displacement's noise; it comes in the
    /// instants of contact. At each of those instants of each stop: what a whitened column (12 x bins) has there, times
    /// the deviation of the noise beyond the even one. Empty without contact.
    Eigen::VectorXd calcBursts(const Eigen::MatrixXcd& white) const;

    /// A change dM of the mass matrix, or of the spin.
    /// @param behind, ahead `apart` from each other about the state: what is demanded is quadratic in the centre of
    ///     gravity
    void calcBodyColumn(const MobileBody& behind, const MobileBody& ahead, double apart, Eigen::MatrixXcd& mount,
                        Eigen::MatrixXcd& bracket) const;

    /// The connection's laws act where it is: relative displacement and lever both move.
    Eigen::MatrixXcd calcPositionColumn(int connection, int axis) const;

    /// Whitened rows of the bracket (6 x bins).
    Eigen::MatrixXcd calcModeColumn(int mode, int which) const;
    Eigen::MatrixXcd calcShapeColumn(int mode, int entry) const;
    /// Of a mode that the model lacks.
    Eigen::MatrixXcd calcAddedMode(const BracketMode& mode) const;
    /// Spectra of what drives the modes (BracketEquation::calcInputs), 12 x bins.
    const Eigen::MatrixXcd& inputs() const { return inputs_; }

    /// What a load (N, 3 x samples) adds to the equations, wherever the model has it act; empty where it adds nothing.
    void calcLoadColumn(const Eigen::MatrixXd& load, Eigen::MatrixXcd& mount, Eigen::MatrixXcd& bracket) const;
    /// The load as the state has it, 3 x samples. @param axis whose alone; 3: of all
    Eigen::MatrixXd calcLoadOf(int axis) const;
    /// @param[out] share of the run's time that the hat covers
    Eigen::MatrixXd calcHatLoad(const LoadHat& hat, double& share) const;

    /// Whitened rows of the bracket: response of a mode that was moving when the recording began, cosine or sine of its
    /// free decay.
    Eigen::MatrixXcd calcTransient(int mode, bool sine) const;

    /// What a sensor's error makes of one part's motion. @return whitened
    Eigen::MatrixXcd calcMotionColumn(const SensorEffect& effect) const;

    /// Needs prepareColumns().
    TurningWrench makeTurningWrench(Part part) const;

    /// Whether some law answers to a change of the motion otherwise than as its mean stiffness and damping do.
    bool varies() const { return varies_; }
    const MotionNoise& motionNoise() const { return motion_noise_; }

    Eigen::MatrixXcd whitenDirection(const Vector6& d) const;

    /// Share of the mount residual's power that lies within contact, tapered.
    double calcContactShare() const;

private:
    using Matrix6X = Eigen::Matrix<double, 6, Eigen::Dynamic>;

    /// What all columns of a mode share: the spectrum of its force (BracketEquation::calcSpectra), and at each bin its
    /// coordinate and its whitened shape.
    struct Modal {
        Eigen::RowVectorXcd force, motion;
        Eigen::MatrixXcd white;
    };
    /// Spectra of the wrench that mean laws and inertia make of an error where the taper rises and falls, beyond those
    /// of the tapered motion.
    Eigen::MatrixXcd calcEdges(const SensorEffect& effect) const;
    /// The same of the bracket's motion: a mode answers to what has been, and its whole response is tapered.
    Eigen::MatrixXcd calcBracketEdges(const SensorEffect& effect) const;
    Eigen::MatrixXcd calcModalEdges(const Eigen::MatrixXd& accelerations, const Eigen::MatrixXcd& tapered) const;
    /// Wrench (6 x samples) that contact makes of an error beyond the mean laws, as it turns with the parts, and the
    /// slow motion that follows.
    Eigen::MatrixXd calcBeyondMean(const SensorEffect& effect) const;
    void addContact(Eigen::Index row, const Vector6& direction);
    void spanContacts();
    Modal makeModal(const BracketMode& mode) const;
    /// At the bins, of a history that follows from its cause as a mode does: the whole response is tapered, as the
    /// residual's is. The response to what is tapered is another, by the slope of the window times the mode's memory.
    Eigen::RowVectorXcd respond(const Eigen::RowVectorXcd& spectrum,
                                const std::function<std::complex<double>(double w)>& response) const;
    /// A motion of the fixed part about its mean, rows x bins.
    Eigen::MatrixXcd transformFixed(Eigen::MatrixXd series) const;
    /// The bracket's response to some of its inputs, from the first on, 6 x bins.
    Eigen::MatrixXcd transformBracket(Eigen::Index first, const Eigen::MatrixXd& inputs) const;

    void calcResiduals();
    MountModel model_;
    OpenLoopRun open_;
    std::unique_ptr<SlowBalance> slow_;
    bool with_bracket_;
    EquationSpectra spectra_;
    MotionNoise motion_noise_;
    RunNoise noise_;
    BracketEquation bracket_;
    Eigen::MatrixXd mount_series_;
    AxisSeries forces_, tangent_;
    std::vector<AxisTangent> axis_tangents_;
    /// On the mobile part by a unit force of each axis (6 x samples); empty where the tangent is its mean.
    std::vector<Matrix6X> unit_wrenches_;
    Matrix6 mean_stiffness_ = Matrix6::Zero(), mean_damping_ = Matrix6::Zero();  // of the relative motion
    Eigen::VectorXd rest_tangent_;
    /// Of an axis that touches a stop: instants of contact, and the noise's deviation there beyond the even one, N.
    struct Contact {
        Vector6 direction;
        std::vector<Eigen::Index> instants;
        Eigen::VectorXd deviation;
        Eigen::VectorXd along_basis;
    };
    std::vector<Contact> contacts_;
    Eigen::MatrixXd contact_basis_;  // 6 x directions that are independent
    bool varies_ = false;
    std::vector<Modal> modal_;
    Eigen::MatrixXcd inputs_, input_spectra_, white_;
};

}  // namespace wems::identify
