/// @file
/// The bracket's equation along a measured motion of the mobile part: the fixed part's motion that load and demanded
/// mount wrench cause, minus the measured one. It does not depend on the mount's laws.
///
/// Each mode is driven by the recorded load, by the base acceleration and by the wrench that the measured motion of
/// the mobile part demands of the mount (with the opposite sign, carried to F's origin), and answers by its exact
/// frequency response: everything is band-limited, so no time integration error enters. The response decays within
/// the zero padding.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>

#include "identify/motion/fourier.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

class BracketEquation {
public:
    explicit BracketEquation(const OpenLoopRun& run);

    /// False if the recording has neither load nor base acceleration, if the fixed part was not measured, or if the
    /// model has no bracket.
    static bool isAvailable(const OpenLoopRun& run, const MountModel& model);

    /// Predicted motion of F: position (m) above rotation vector (rad), 6 x samples.
    Eigen::MatrixXd calcPrediction(const MountModel& model) const { return calcPrediction(model, calcInputs(model)); }
    /// Response to given inputs (12 x samples).
    Eigen::MatrixXd calcPrediction(const MountModel& model, const Eigen::Ref<const Eigen::MatrixXd>& inputs) const;
    /// Spectra of rows of samples, as long as the response of a mode lasts.
    Eigen::MatrixXcd calcSpectra(const Eigen::Ref<const Eigen::MatrixXd>& rows) const { return fourier_.forward(rows); }
    /// A row with such a spectrum through a frequency response (of w, rad/s): its history in the recording, from rest.
    Eigen::RowVectorXd respond(const Eigen::RowVectorXcd& spectrum,
                               const std::function<std::complex<double>(double w)>& response) const;
    /// On the fixed part, at F's origin, by a demanded wrench of the mobile part (6 x samples, about M's origin).
    Eigen::MatrixXd calcWrench(const Eigen::Ref<const Eigen::MatrixXd>& demand) const;
    /// What drives the modes: the wrench on the fixed part at F's origin (force above moment), with the load if it acts
    /// on that part; the load with the model's correction at the bracket's load point; and the base acceleration with
    /// the opposite sign; 12 x samples.
    Eigen::MatrixXd calcInputs(const MountModel& model) const;

    /// Predicted minus measured motion.
    Eigen::MatrixXd calcResidual(const MountModel& model) const;

private:
    /// Response to given modal forces (modes x samples).
    Eigen::MatrixXd calcResponse(const MountModel& model, const Eigen::Ref<const Eigen::MatrixXd>& modal_forces) const;

    const OpenLoopRun* run_;
    Fourier fourier_;
};

/// What a mode's force is of the inputs: shape at the interface, at the load point, participation of the base.
Eigen::Matrix<double, 12, 1> calcParticipation(const BracketMode& mode);

/// Translation above rotation.
Eigen::Matrix<double, 6, 1> calcShape(const BracketMode& mode);

/// Frequency response of a mode, kg^1/2 m per modal force, at angular frequency w.
std::complex<double> calcModalResponse(const BracketMode& mode, double w);

}  // namespace wems::identify
