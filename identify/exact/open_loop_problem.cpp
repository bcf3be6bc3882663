#include "identify/exact/open_loop_problem.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/exact/calibration.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/problem/slow_balance.hpp"

namespace wems::identify {
namespace {

constexpr int kVarianceSteps = 100;
constexpr double kVarianceAccuracy = 1e-6;

bool sameShape(const BracketMode& a, const BracketMode& b) {
    return calcParticipation(a) == calcParticipation(b);
}

bool sameResonance(const BracketMode& a, const BracketMode& b) {
    return a.frequency == b.frequency && a.damping_ratio == b.damping_ratio;
}

bool sameModes(const std::vector<BracketMode>& a, const std::vector<BracketMode>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const BracketMode& one, const BracketMode& other) {
        return sameShape(one, other) && sameResonance(one, other);
    });
}

/// Gain − 1, delay and rotation that all channels of a side share.
Eigen::Matrix<float, 5, 1> calcSideFault(const MountModel& model, const std::string& side) {
    Eigen::Matrix<float, 5, 1> fault = Eigen::Matrix<float, 5, 1>::Zero();
    for (const auto& sensor : model.sensors) {
        if (sensor.channel != side) continue;
        fault[0] += static_cast<float>(sensor.gain - 1);
        fault[1] += static_cast<float>(sensor.delay);
        fault.tail<3>() += sensor.rotation.cast<float>();
    }
    return fault;
}

bool sameSides(const MountModel& a, const MountModel& b) {
    return calcSideFault(a, "mobile") == calcSideFault(b, "mobile") &&
           calcSideFault(a, "fixed") == calcSideFault(b, "fixed");
}

bool sameLoad(const MountModel& a, const MountModel& b) {
    if (a.load.has_value() != b.load.has_value()) return false;
    return !a.load ||
           (a.load->gain_over_frequency == b.load->gain_over_frequency && a.load->axis_gain == b.load->axis_gain);
}

}  // namespace

OpenLoopProblem::OpenLoopProblem(std::vector<OpenLoopRun> runs, const MountModel& model, double gain_scatter)
    : runs_(std::move(runs)), gain_scatter_(gain_scatter) {
    for (const auto& run : runs_)
        brackets_.push_back(BracketEquation::isAvailable(run, model) ? std::make_unique<BracketEquation>(run)
                                                                     : nullptr);
    rewhiten(model);
}

bool OpenLoopProblem::hasSlowBalance() const {
    return std::any_of(whitenings_.begin(), whitenings_.end(),
                       [](const auto& whitening) { return whitening->slowBalance() != nullptr; });
}

void OpenLoopProblem::rewhiten(const MountModel& model) {
    whitenings_.resize(runs_.size());
    runParallel(runs_.size(), [&](std::size_t r) { followSlowMotion(runs_[r], model); });
    // Plans of transforms may not be made by two threads at once.
    for (std::size_t r = 0; r < runs_.size(); ++r)
        whitenings_[r] = std::make_unique<Whitening>(runs_[r], model, brackets_[r] != nullptr);
    offsets_.clear();
    size_ = 0;
    for (const auto& whitening : whitenings_) {
        offsets_.push_back(size_);
        size_ += whitening->size();
    }
    reference_ = model;
    makeCalibrationColumns();
    setReference(model);
}

void OpenLoopProblem::makeCalibrationColumns() {
    const auto channels = 6 * static_cast<Eigen::Index>(reference_.connections.size());
    calibration_ = Eigen::MatrixXf::Zero(size_, channels + 3);
    sides_ = Eigen::MatrixXf::Zero(size_, 10);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const CalibrationResponse response(runs_[r], reference_, brackets_[r].get());
        for (Eigen::Index c = 0; c < calibration_.cols(); ++c) {
            Eigen::MatrixXd mount, bracket;
            response.calc(c, mount, bracket);
            calibration_.col(c).segment(offsets_[r], whitenings_[r]->size()) =
                static_cast<float>(gain_scatter_) * whitenings_[r]->apply(mount, bracket);
        }
        for (int c = 0; c < 10; ++c) {
            if (c >= 5 && !runs_[r].fixed_measured) continue;
            Eigen::MatrixXd mount, bracket;
            response.calcSide(c < 5, c % 5, mount, bracket);
            sides_.col(c).segment(offsets_[r], whitenings_[r]->size()) = whitenings_[r]->apply(mount, bracket);
        }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        (calibration_.transpose() * calibration_).cast<double>());
    calibration_ *= solver.eigenvectors().cast<float>();
    calibration_power_ = solver.eigenvalues().cwiseMax(0.0);
}

void OpenLoopProblem::addSideFaults(const MountModel& model, float sign, Eigen::VectorXf& values) const {
    Eigen::Matrix<float, 10, 1> fault;
    fault << calcSideFault(model, "mobile"), calcSideFault(model, "fixed");
    if (fault.isZero(0.0F)) return;
    if (values.size() == 0) values = Eigen::VectorXf::Zero(size_);
    for (int c = 0; c < 10; ++c)
        if (fault[c] != 0) values += sign * fault[c] * sides_.col(c);
}

WhiteVector OpenLoopProblem::makeVector(Eigen::VectorXf values) const {
    WhiteVector result;
    result.calibration = (calibration_.transpose() * values).cast<double>();
    result.values = std::move(values);
    return result;
}

Eigen::VectorXf OpenLoopProblem::calcValues(const MountModel& model) const {
    Eigen::VectorXf values(size_);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        Eigen::MatrixXd bracket;
        if (brackets_[r]) bracket = brackets_[r]->calcResidual(model);
        values.segment(offsets_[r], whitenings_[r]->size()) =
            whitenings_[r]->apply(calcMountResidual(runs_[r], model), bracket);
    }
    addSideFaults(model, 1.0F, values);
    return values;
}

void OpenLoopProblem::setReference(const MountModel& model) {
    reference_ = model;
    reference_residual_ = makeVector(calcValues(model));
    reference_inputs_.assign(runs_.size(), {});
    for (std::size_t r = 0; r < runs_.size(); ++r)
        if (brackets_[r]) reference_inputs_[r] = brackets_[r]->calcInputSpectra(model);
}

Eigen::MatrixXd OpenLoopProblem::calcBracketDifference(std::size_t run, const MountModel& from,
                                                       const MountModel& to) const {
    const bool same_body = sameBody(from.body, to.body), same_load = sameLoad(from, to);
    const bool same_modes = sameModes(from.bracket, to.bracket);
    if (!brackets_[run] || (same_body && same_load && same_modes)) return {};
    if (same_modes && same_load) return brackets_[run]->calcBodyDifference(from, to);
    return brackets_[run]->calcPrediction(to) - brackets_[run]->calcPrediction(from);
}

WhiteVector OpenLoopProblem::calcResidual(const MountModel& model) const {
    auto result = calcDifference(reference_, model);
    if (result.isZero()) return reference_residual_;
    result.values += reference_residual_.values;
    result.calibration += reference_residual_.calibration;
    return result;
}

bool OpenLoopProblem::differInLawsAlone(const MountModel& from, const MountModel& to) {
    return sameBody(from.body, to.body) && sameLoad(from, to) && sameModes(from.bracket, to.bracket) &&
           sameSides(from, to);
}

bool OpenLoopProblem::differInModesAlone(const MountModel& from, const MountModel& to) const {
    return !sameModes(from.bracket, to.bracket) && sameBody(from.body, to.body) && sameLoad(from, to) &&
           sameBody(from.body, reference_.body) && sameLoad(from, reference_);
}

void OpenLoopProblem::addModesDifference(std::size_t run, const MountModel& from, const MountModel& to,
                                         Eigen::VectorXf& values) const {
    const Whitening& whitening = *whitenings_[run];
    const auto calcForce = [&](const BracketMode& mode) -> Eigen::VectorXcd {
        return reference_inputs_[run].transpose() * calcParticipation(mode).cast<std::complex<double>>();
    };
    const auto add = [&](const BracketMode& mode, const Eigen::VectorXd& coordinate) {
        addAlong(whitening.whitenDirection(Equation::bracket, calcShape(mode)), whitening.calcSpectrum(coordinate),
                 values.segment(offsets_[run] + whitening.mountSize(), whitening.mountSize()));
    };
    const auto &before = from.bracket, &after = to.bracket;
    for (std::size_t j = 0; j < std::max(before.size(), after.size()); ++j) {
        const bool was = j < before.size(), is = j < after.size();
        if (was && is && sameShape(before[j], after[j])) {
            if (!sameResonance(before[j], after[j]))
                add(after[j], brackets_[run]->calcModeDifference(before[j], after[j], calcForce(after[j])));
            continue;
        }
        if (is) add(after[j], brackets_[run]->calcModeCoordinate(after[j], calcForce(after[j])));
        if (was) add(before[j], -brackets_[run]->calcModeCoordinate(before[j], calcForce(before[j])));
    }
}

WhiteVector OpenLoopProblem::calcDifference(const MountModel& from, const MountModel& to) const {
    WhiteVector result;
    const auto touch = [&] {
        if (!result.isZero()) return;
        result.values = Eigen::VectorXf::Zero(size_);
        result.calibration = Eigen::VectorXd::Zero(calibration_.cols());
    };
    const auto addCalibration = [&](Eigen::Index first, Eigen::Index count) {
        result.calibration +=
            (calibration_.middleRows(first, count).transpose() * result.values.segment(first, count)).cast<double>();
    };
    const bool modes_alone = differInModesAlone(from, to);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const Eigen::Index first = offsets_[r], size = whitenings_[r]->mountSize();
        const Eigen::MatrixXd mount = calcMountDifference(runs_[r], from, to);
        if (mount.size() > 0) {
            touch();
            whitenings_[r]->apply(Equation::mount, mount, result.values.segment(first, size));
            addCalibration(first, size);
        }
        if (!brackets_[r]) continue;
        const Eigen::MatrixXd bracket = modes_alone ? Eigen::MatrixXd() : calcBracketDifference(r, from, to);
        if (bracket.size() == 0 && !modes_alone) continue;
        touch();
        if (modes_alone) {
            addModesDifference(r, from, to, result.values);
        } else {
            whitenings_[r]->apply(Equation::bracket, bracket, result.values.segment(first + size, size));
        }
        addCalibration(first + size, size);
    }
    Eigen::VectorXf sides;
    addSideFaults(to, 1.0F, sides);
    addSideFaults(from, -1.0F, sides);
    if (sides.size() == 0) return result;
    if (result.isZero()) return makeVector(std::move(sides));
    return makeVector(result.values + sides);
}

namespace {

/// In blocks, so that single precision does not lose the sum.
double calcDot(const Eigen::VectorXf& a, const Eigen::VectorXf& b) {
    double sum = 0;
    constexpr Eigen::Index kBlock = 4096;
    for (Eigen::Index i = 0; i < a.size(); i += kBlock) {
        const Eigen::Index count = std::min(kBlock, a.size() - i);
        sum += static_cast<double>(a.segment(i, count).dot(b.segment(i, count)));
    }
    return sum;
}

}  // namespace

double OpenLoopProblem::product(const WhiteVector& a, const WhiteVector& b, double variance) const {
    if (a.isZero() || b.isZero()) return 0;
    return calcDot(a.values, b.values) -
           (a.calibration.array() * b.calibration.array() / (calibration_power_.array() + variance)).sum();
}

double OpenLoopProblem::calcVariance(const WhiteVector& residual) const {
    const auto count = static_cast<double>(size_);
    const double square = calcDot(residual.values, residual.values);
    const Eigen::ArrayXd products = residual.calibration.array().square();
    // From above: each step lowers it, down to the largest solution.
    double variance = std::max(1.0, square / count);
    for (int i = 0; i < kVarianceSteps; ++i) {
        const double next =
            std::max(1.0, (square - (products / (calibration_power_.array() + variance)).sum()) / count);
        if (next > (1 - kVarianceAccuracy) * variance) break;
        variance = next;
    }
    return variance;
}

double OpenLoopProblem::calcMisfit(const WhiteVector& residual) const {
    return product(residual, residual, calcVariance(residual)) / static_cast<double>(size_);
}

Eigen::VectorXf OpenLoopProblem::removeCalibration(const WhiteVector& residual) const {
    Eigen::VectorXd gains = residual.calibration.array() / (calibration_power_.array() + calcVariance(residual));
    // What a wrong model leaves would take gains beyond all scatter.
    const double size = gains.norm() / std::sqrt(static_cast<double>(gains.size()));
    if (size > 1) gains /= size;
    return residual.values - calibration_ * gains.cast<float>();
}

}  // namespace wems::identify
