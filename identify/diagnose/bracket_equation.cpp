#include "identify/diagnose/bracket_equation.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <complex>
#include <limits>

#include "identify/diagnose/mount_equation.hpp"
#include "models/load_gain.hpp"
#include "models/pi.hpp"

namespace wems::identify {
namespace {

constexpr double kPadding = 10.0;  // s for the response to die out

}  // namespace

std::complex<double> calcModalResponse(const BracketMode& mode, double w) {
    const double w0 = kTwoPi * mode.frequency;
    const double real = w0 * w0 - w * w, imaginary = 2 * mode.damping_ratio * w0 * w;
    const double square = real * real + imaginary * imaginary;
    return {real / square, -imaginary / square};
}

Eigen::Matrix<double, 6, 1> calcShape(const BracketMode& mode) {
    Eigen::Matrix<double, 6, 1> shape;
    shape << mode.translation, mode.rotation;
    return shape;
}

BracketEquation::BracketEquation(const OpenLoopRun& run)
    : run_(&run), fourier_(run.sampleCount() + static_cast<int>(kPadding / run.interval)) {}

bool BracketEquation::isAvailable(const OpenLoopRun& run, const MountModel& model) {
    return !model.bracket.empty() && run.fixed_measured && (run.load.cols() > 0 || run.base.cols() > 0);
}

Eigen::MatrixXd BracketEquation::calcResponse(const MountModel& model,
                                              const Eigen::Ref<const Eigen::MatrixXd>& modal_forces) const {
    const Eigen::MatrixXcd spectra = fourier_.forward(modal_forces);
    Eigen::MatrixXcd motion = Eigen::MatrixXcd::Zero(6, spectra.cols());
    const double step = kTwoPi / (fourier_.size() * run_->interval);
    for (std::size_t j = 0; j < model.bracket.size(); ++j) {
        const auto& mode = model.bracket[j];
        const auto shape = calcShape(mode);
        for (Eigen::Index k = 0; k < spectra.cols(); ++k) {
            const auto response = calcModalResponse(mode, step * static_cast<double>(k));
            motion.col(k) += shape * (response * spectra(static_cast<Eigen::Index>(j), k));
        }
    }
    return fourier_.inverse(motion, run_->sampleCount());
}

Eigen::MatrixXd BracketEquation::calcModalForces(const MountModel& model,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& demand) const {
    const auto modes = static_cast<Eigen::Index>(model.bracket.size());
    Eigen::MatrixXd shapes(modes, 6);
    for (Eigen::Index j = 0; j < modes; ++j) {
        const auto& mode = model.bracket[static_cast<std::size_t>(j)];
        shapes.row(j) << mode.translation.transpose(), mode.rotation.transpose();
    }
    Eigen::MatrixXd on_fixed = -demand;
    for (int k = 0; k < run_->sampleCount(); ++k) {
        const Eigen::Vector3d arm = run_->mobile.p.col(k) - run_->fixed.p.col(k);
        on_fixed.block<3, 1>(3, k) += arm.cross(on_fixed.block<3, 1>(0, k).eval());
    }
    return shapes * on_fixed;
}

Eigen::MatrixXd BracketEquation::calcLoadForces(const MountModel& model) const {
    const auto modes = static_cast<Eigen::Index>(model.bracket.size());
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(modes, run_->sampleCount());
    Eigen::Matrix3Xd load = run_->load;
    if (model.load)
        for (Eigen::Index k = 0; k < load.cols(); ++k)
            load.col(k) *= calcLoadGain(
                *model.load, k < run_->swept.size() ? run_->swept[k] : std::numeric_limits<double>::quiet_NaN());
    for (Eigen::Index j = 0; j < modes; ++j) {
        const auto& mode = model.bracket[static_cast<std::size_t>(j)];
        if (load.cols() > 0) forces.row(j) += mode.load_translation.transpose() * load;
        if (run_->base.cols() > 0) forces.row(j) -= mode.base_participation.transpose() * run_->base;
    }
    return forces;
}

Eigen::MatrixXd BracketEquation::calcPrediction(const MountModel& model) const {
    const Eigen::MatrixXd demand = calcDemand(*run_, model.body, model.gravity);
    return calcResponse(model, calcModalForces(model, demand) + calcLoadForces(model));
}

Eigen::MatrixXcd BracketEquation::calcForceSpectra(const MountModel& model) const {
    const Eigen::MatrixXd demand = calcDemand(*run_, model.body, model.gravity);
    return fourier_.forward(calcModalForces(model, demand) + calcLoadForces(model));
}

Eigen::VectorXd BracketEquation::calcModeDifference(const BracketMode& from, const BracketMode& to,
                                                    const Eigen::Ref<const Eigen::VectorXcd>& force_spectrum) const {
    const double step = kTwoPi / (fourier_.size() * run_->interval);
    Eigen::MatrixXcd coordinate(1, force_spectrum.size());
    for (Eigen::Index k = 0; k < force_spectrum.size(); ++k) {
        const double w = step * static_cast<double>(k);
        coordinate(0, k) = (calcModalResponse(to, w) - calcModalResponse(from, w)) * force_spectrum[k];
    }
    return fourier_.inverse(coordinate, run_->sampleCount()).transpose();
}

Eigen::MatrixXd BracketEquation::calcBodyDifference(const MountModel& from, const MountModel& to) const {
    const Eigen::MatrixXd demand = calcDemand(*run_, to.body, to.gravity) - calcDemand(*run_, from.body, from.gravity);
    return calcResponse(to, calcModalForces(to, demand));
}

Eigen::MatrixXd BracketEquation::calcResidual(const MountModel& model) const {
    Eigen::MatrixXd residual = calcPrediction(model);
    residual.topRows(3) -= run_->fixed.p;
    residual.bottomRows(3) -= run_->fixed.theta;
    return residual;
}

}  // namespace wems::identify
