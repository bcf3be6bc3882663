#include "identify/problem/bracket_equation.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <complex>

#include "identify/problem/mount_equation.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

constexpr double kPadding =
    50;  // periods of the lowest excited frequency, for the response of modes above it to die out

/// modes x 12.
Eigen::MatrixXd calcParticipations(const MountModel& model) {
    Eigen::MatrixXd rows(model.bracket.size(), 12);
    for (Eigen::Index j = 0; j < rows.rows(); ++j) rows.row(j) = calcParticipation(model.bracket[j]).transpose();
    return rows;
}

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

Eigen::Matrix<double, 12, 1> calcParticipation(const BracketMode& mode) {
    Eigen::Matrix<double, 12, 1> participation;
    participation << mode.translation, mode.rotation, mode.load_translation, mode.base_participation;
    return participation;
}

BracketEquation::BracketEquation(const OpenLoopRun& run)
    : run_(&run), fourier_(run.sampleCount() + static_cast<int>(kPadding / (run.band.lowest * run.interval))) {}

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
            motion.col(k) += shape * (response * spectra(j, k));
        }
    }
    return fourier_.inverse(motion, run_->sampleCount());
}

Eigen::RowVectorXd BracketEquation::respond(const Eigen::RowVectorXcd& spectrum,
                                            const std::function<std::complex<double>(double w)>& response) const {
    Eigen::RowVectorXcd answer = spectrum;
    const double step = kTwoPi / (fourier_.size() * run_->interval);
    for (Eigen::Index k = 0; k < answer.size(); ++k) answer[k] *= response(step * static_cast<double>(k));
    return fourier_.inverse(answer, run_->sampleCount());
}

Eigen::MatrixXd BracketEquation::calcWrench(const Eigen::Ref<const Eigen::MatrixXd>& demand) const {
    Eigen::MatrixXd on_fixed = -demand;
    for (int k = 0; k < run_->sampleCount(); ++k) {
        const Eigen::Vector3d arm = run_->mobile.p.col(k) - run_->fixed.p.col(k);
        on_fixed.block<3, 1>(3, k) += arm.cross(on_fixed.block<3, 1>(0, k).eval());
    }
    return on_fixed;
}

Eigen::MatrixXd BracketEquation::calcInputs(const MountModel& model) const {
    Eigen::MatrixXd inputs = Eigen::MatrixXd::Zero(12, run_->sampleCount());
    Eigen::MatrixXd demand = calcDemand(*run_, model.body, model.gravity);
    const Eigen::MatrixXd load = calcLoad(*run_, model);
    if (loadsMobilePart(*run_, model)) demand -= calcLoadWrench(*run_, *model.load_point, load);
    inputs.topRows(6) = calcWrench(demand);
    if (load.cols() > 0 && !model.load_point) inputs.middleRows(6, 3) = load;
    if (load.cols() > 0 && model.load_point && model.load_point->part == Part::fixed)
        inputs.topRows(6) += calcLoadWrench(*run_, *model.load_point, load);
    if (run_->base.cols() > 0) inputs.bottomRows(3) = -run_->base;
    return inputs;
}

Eigen::MatrixXd BracketEquation::calcPrediction(const MountModel& model,
                                                const Eigen::Ref<const Eigen::MatrixXd>& inputs) const {
    return calcResponse(model, calcParticipations(model) * inputs);
}

Eigen::MatrixXd BracketEquation::calcResidual(const MountModel& model) const {
    Eigen::MatrixXd residual = calcPrediction(model);
    residual.topRows(3) -= run_->fixed.p;
    residual.bottomRows(3) -= run_->fixed.theta;
    return residual;
}

}  // namespace wems::identify
