#include "identify/problem/run_noise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Matrix6c = Eigen::Matrix<std::complex<double>, 6, 6>;

// Of the motion and the load: sampling, smoothing, second-order terms. Without any noise the true model's equations
// leave 1e-5 of a clear mount's and 1.5e-4 of the bracket's. It must not be much more: noise that is not there lets a
// gain of the load's path grow, along with all sensors'.
constexpr double kDiscrepancy = 1e-4;
constexpr double kSmoothedOver = 0.2;  // of the lowest excited frequency, width of the spectra's smoothing
constexpr double kJitter = 1e-9;       // of the diagonal, so that exact data have a factor
// Bins at which the products of the columns' noise are taken: their cost grows with it, and a factor on all forces,
// whose product is known by theory, comes out within 2 %. A resonance narrower than their distance may be missed.
constexpr Eigen::Index kSamples = 64;

Matrix6 calcFitCovariance(const SensorLayout& layout, const TestRun& run, int group) {
    const GroupSamples samples = collectGroup(run.recording, layout, group);
    if (samples.empty()) return Matrix6::Zero();
    const Eigen::MatrixXd design = makeChannelDesign(layout, samples.channels);
    return (design.transpose() * design).completeOrthogonalDecomposition().pseudoInverse();
}

/// Variance of a sample of the two motions' noise, as white noise of the density at each bin of the transform; what the
/// motions themselves have wrong stands where they are. Below the corner of a slow motion nothing is left: it follows.
std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> calcDensities(const OpenLoopRun& run, const MotionNoise& motion,
                                                                      const EquationSpectra& spectra,
                                                                      const Eigen::MatrixXd& wrong, double corner) {
    Eigen::Matrix<double, 6, 12> relative;
    relative << Matrix6::Identity(), -Matrix6::Identity();
    std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> densities;
    const double kept = run.raw_interval / run.interval;
    for (Eigen::Index k = 0; k < spectra.densityCount(); ++k) {
        const double f = spectra.densityFrequency(std::max<Eigen::Index>(1, k)), w = kTwoPi * f;
        densities.push_back(Matrix6::Zero());
        if (f < corner) continue;
        const double passed = std::pow(run.filter.calcResponse(f), 2);
        densities.back() = kept * passed *
                           (motion.covariance(Part::mobile, w) + motion.covariance(Part::fixed, w) +
                            relative * motion.foldedCovariance(run.aliasing, w) * relative.transpose());
    }
    for (Eigen::Index b = 0; b < wrong.cols(); ++b)
        densities[spectra.firstBin() + b].diagonal() +=
            (wrong.col(b).head<6>() + wrong.col(b).tail<6>()) / run.taper.squaredNorm();
    return densities;
}

/// How the load's axes go together, 1 on the diagonal of those that are loaded. What its gain has wrong is wrong along
/// the load: across it nothing is, and a number that only what acts there would tell is not known.
Eigen::Matrix3d calcLoadCorrelation(const OpenLoopRun& run) {
    if (run.load.cols() == 0) return Eigen::Matrix3d::Zero();
    const Eigen::Matrix3Xd load = run.load * run.taper.asDiagonal();
    const Eigen::Matrix3d power = load * load.transpose();
    const Eigen::Vector3d size = power.diagonal().cwiseSqrt();
    const Eigen::Vector3d inverse = (size.array() > 0).select(size.cwiseInverse(), 0.0);
    return inverse.asDiagonal() * power * inverse.asDiagonal();
}

/// Square root of a covariance that may be singular.
/// @param covariance of dynamic size, whose decomposition is compiled already (eigen_instances.hpp)
Eigen::MatrixXcd calcRoot(const Eigen::MatrixXcd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(covariance);
    return solver.eigenvectors() *
           solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().cast<std::complex<double>>().asDiagonal();
}

}  // namespace

Eigen::VectorXd EquationSpectra::calcSeries(const Eigen::VectorXcd& values) const {
    Eigen::MatrixXcd spectrum = Eigen::MatrixXcd::Zero(1, fourier_.binCount());
    spectrum.row(0).segment(first_, bins_) = values.transpose();
    return fourier_.size() * fourier_.inverse(spectrum, run_->sampleCount()).transpose();
}

double EquationSpectra::densityFrequency(Eigen::Index k) const {
    return static_cast<double>(k) / (fourier_.size() * run_->interval);
}

Eigen::VectorXd EquationSpectra::calcModulated(const Eigen::Ref<const Eigen::RowVectorXd>& factor,
                                               const Eigen::RowVectorXd& density) const {
    const Eigen::RowVectorXd tapered = factor.cwiseProduct(run_->taper.transpose());
    const Eigen::MatrixXcd power = fourier_.forward(tapered).cwiseAbs2().cast<std::complex<double>>();
    // Convolution of the two spectra as the product of what they are the transforms of.
    const Eigen::MatrixXd product =
        fourier_.inverse(power, fourier_.size())
            .cwiseProduct(fourier_.inverse(density.cast<std::complex<double>>(), fourier_.size()));
    return fourier_.forward(product).row(0).segment(first_, bins_).real().cwiseMax(0.0).transpose();
}

EquationSpectra::EquationSpectra(const OpenLoopRun& run, double from, double to)
    : run_(&run), fourier_(run.sampleCount()) {
    const double spacing = 1 / (fourier_.size() * run.interval);
    first_ = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::ceil(from / spacing)));
    const auto last = std::min<Eigen::Index>(fourier_.binCount() - 1, static_cast<Eigen::Index>(to / spacing));
    bins_ = std::max<Eigen::Index>(1, last - first_ + 1);
    gain_ = run.raw_interval / run.interval * run.taper.squaredNorm();
}

double EquationSpectra::frequency(Eigen::Index bin) const {
    return static_cast<double>(first_ + bin) / (fourier_.size() * run_->interval);
}

double EquationSpectra::angular(Eigen::Index bin) const {
    return kTwoPi * frequency(bin);
}

Eigen::MatrixXcd EquationSpectra::transform(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
    return fourier_.forward(rows, run_->taper, first_, bins_);
}

Eigen::MatrixXcd EquationSpectra::transformSamples(const Eigen::Ref<const Eigen::MatrixXd>& samples) const {
    return fourier_.forwardSamples(samples, run_->taper, first_, bins_);
}

Eigen::MatrixXd EquationSpectra::calcPower(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
    const double spacing = 1 / (fourier_.size() * run_->interval);
    return smoothPower(transform(rows), static_cast<Eigen::Index>(0.5 * kSmoothedOver * run_->band.lowest / spacing));
}

MotionNoise::MotionNoise(const TestRun& run, const SensorLayout& layout) {
    for (std::size_t g = 0; g < layout.groups.size(); ++g) {
        const auto& group = layout.groups[g];
        const bool mobile = group.part == Part::mobile;
        const PartMotion& motion = mobile ? run.motion.mobile : run.motion.fixed;
        Side& side = sides_[mobile ? 0 : 1];
        const Matrix6 covariance = calcFitCovariance(layout, run, static_cast<int>(g));
        if (group.derivative == Derivative::displacement && motion.displacement_measured) {
            side.displacement = true;
            side.by_displacement = covariance;
            side.displacement_density = &run.noise[g];
        }
        if (group.derivative == Derivative::acceleration && motion.acceleration_measured) {
            side.acceleration = true;
            side.by_acceleration = covariance;
            side.acceleration_density = &run.noise[g];
        }
        side.ratio = motion.displacement_noise / motion.acceleration_noise;
    }
}

MotionNoise::Weights MotionNoise::weights(Part part, double w) const {
    const Side& side = sides_[part == Part::mobile ? 0 : 1];
    if (!side.acceleration) return {side.displacement ? 1.0 : 0.0, 0.0};
    if (!side.displacement) return {0.0, 1.0};
    const double ratio = w * w * side.ratio;
    const double acceleration = ratio * ratio / (1 + ratio * ratio);
    return {1 - acceleration, acceleration};
}

Matrix6 MotionNoise::covariance(Part part, double w) const {
    const Side& side = sides_[part == Part::mobile ? 0 : 1];
    const Weights weight = weights(part, w);
    Matrix6 sum = Matrix6::Zero();
    if (side.displacement)
        sum += weight.displacement * weight.displacement * side.displacement_density->at(w / kTwoPi) *
               side.by_displacement;
    if (side.acceleration)
        sum += weight.acceleration * weight.acceleration * side.acceleration_density->at(w / kTwoPi) / (w * w * w * w) *
               side.by_acceleration;
    return sum;
}

Eigen::Matrix<double, 12, 12> MotionNoise::foldedCovariance(const Eigen::Matrix<double, 12, 12>& accelerations,
                                                            double w) const {
    Eigen::Matrix<double, 12, 1> weight;
    weight << Vector6::Constant(weights(Part::mobile, w).acceleration),
        Vector6::Constant(weights(Part::fixed, w).acceleration);
    weight /= w * w;
    return weight.asDiagonal() * accelerations * weight.asDiagonal();
}

RunNoise::RunNoise(const TestRun& test, const OpenLoopRun& run, const MountModel& model, const MotionNoise& motion,
                   const EquationSpectra& spectra, const SlowBalance* slow, bool with_bracket) {
    const Matrix6 M = calcMassMatrix(model.body);
    const Vector6 freedom = calcFreedom(model.body);
    std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> directions;
    std::vector<DynamicStiffness> stiffnesses;
    std::vector<Eigen::RowVectorXd> contact;
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const auto c = static_cast<int>(i);
            const AxisLaw& law = model.connections[i].axis[a];
            const Vector6 d = calcAxisDirection(model, c, a);
            const Eigen::Index row = 3 * static_cast<Eigen::Index>(i) + a;
            directions.push_back(d * d.transpose());
            stiffnesses.push_back(calcDynamicStiffness(run, law, row));
            contact.push_back(calcStiffnessFluctuation(run, law, row));
        }
    Eigen::MatrixXd poses(12, run.sampleCount());
    poses << run.mobile.p, run.mobile.theta, run.fixed.p, run.fixed.theta;
    poses.colwise() -= poses.rowwise().mean().eval();
    const Eigen::MatrixXd motion_power = spectra.calcPower(poses);
    const Eigen::MatrixXd load_power =
        run.load.cols() > 0 ? spectra.calcPower(calcLoad(run, model)) : Eigen::MatrixXd::Zero(3, spectra.binCount());
    const Eigen::Matrix3d load_correlation = calcLoadCorrelation(run);
    const double gain = spectra.noiseGain(), part = kDiscrepancy * kDiscrepancy;
    std::optional<Eigen::Matrix<double, 6, 3>> load_arm;
    if (model.load_point) load_arm = calcLoadArm(*model.load_point);

    // In contact the noise of all frequencies, modulated by the stop, enters each of them.
    Eigen::MatrixXd& contact_power = contact_power_;
    contact_power.setZero(directions.size(), spectra.binCount());
    contact_variances_.assign(directions.size(), 0.0);
    std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> densities;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const double square = contact[i].squaredNorm() / static_cast<double>(run.sampleCount());
        if (!(square > 0)) continue;
        const Matrix6& along = directions[i];  // d dᵀ: variance along d is dᵀ P d = trace(along P)
        const Eigen::Index row = i;
        if (densities.empty())
            densities = calcDensities(run, motion, spectra, part * motion_power,
                                      slow != nullptr ? slow->cornerFrequency() : 0.0);
        Eigen::RowVectorXd density(spectra.densityCount());
        for (Eigen::Index k = 0; k < density.size(); ++k) density[k] = (along * densities[k]).trace();
        contact_power.row(row) = spectra.calcModulated(contact[i], density).transpose();
        contact_variances_[i] = contact_power.row(row).mean() / (square * run.taper.squaredNorm());
    }
    whiteners_.reserve(spectra.binCount());
    const Eigen::Index every = std::max<Eigen::Index>(1, spectra.binCount() / kSamples);
    for (Eigen::Index b = 0; b < spectra.binCount(); ++b) {
        const double w = spectra.angular(b);
        Matrix6c stiffness = Matrix6c::Zero();
        for (std::size_t i = 0; i < directions.size(); ++i)
            stiffness += stiffnesses[i].at(w) * directions[i].cast<std::complex<double>>();
        Matrix12c P = Matrix12c::Zero(), A = Matrix12c::Zero(), S = Matrix12c::Zero();
        P.topLeftCorner<6, 6>() = (gain * motion.covariance(Part::mobile, w)).cast<std::complex<double>>();
        P.bottomRightCorner<6, 6>() = (gain * motion.covariance(Part::fixed, w)).cast<std::complex<double>>();
        P += (gain * motion.foldedCovariance(run.aliasing, w)).cast<std::complex<double>>();
        P.diagonal() += (part * motion_power.col(b)).cast<std::complex<double>>();
        A.topLeftCorner<6, 6>() = stiffness - (w * w * M).cast<std::complex<double>>();
        A.topRightCorner<6, 6>() = -stiffness;
        Matrix6c receptance = Matrix6c::Zero();
        Eigen::Matrix3d load_covariance = Eigen::Matrix3d::Zero();
        Eigen::Matrix<std::complex<double>, 12, 3> by_load = Eigen::Matrix<std::complex<double>, 12, 3>::Zero();
        if (load_arm && model.load_point->part == Part::mobile)
            by_load.topRows<6>() = -load_arm->cast<std::complex<double>>();
        if (with_bracket) {
            for (const auto& mode : model.bracket) {
                const auto shape = calcShape(mode);
                const auto response = calcModalResponse(mode, w);
                receptance += response * (shape * shape.transpose()).cast<std::complex<double>>();
                if (!load_arm)
                    by_load.bottomRows<6>() +=
                        response * (shape * mode.load_translation.transpose()).cast<std::complex<double>>();
            }
            if (load_arm) by_load.bottomRows<6>() = receptance * load_arm->cast<std::complex<double>>();
            A.bottomLeftCorner<6, 6>() = receptance * (w * w * M).cast<std::complex<double>>();
            A.bottomRightCorner<6, 6>() = -Matrix6c::Identity();
        }
        if (run.load.cols() > 0) {
            const Eigen::Vector3d wrong = (part * load_power.col(b)).cwiseSqrt();
            load_covariance = wrong.asDiagonal() * load_correlation * wrong.asDiagonal();
            // Taking a gain off the load takes it off its noise.
            const Eigen::Array3d gains = model.load ? calcLoadGains(*model.load, w / kTwoPi) : Eigen::Vector3d::Ones();
            load_covariance.diagonal().array() += gain * test.load_noise.at(w / kTwoPi) * gains.square();
            S += by_load * load_covariance * by_load.adjoint();
        }
        const Matrix12c PA = P * A.adjoint();
        S += A * PA;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const double power = contact_power(i, b);
            if (power > 0) S.topLeftCorner<6, 6>() += (power * directions[i]).cast<std::complex<double>>();
        }
        if (!with_bracket) {
            S.bottomRows<6>().setZero();
            S.rightCols<6>().setZero();
            S.bottomRightCorner<6, 6>().setIdentity();
        }
        for (int i = 0; i < 6; ++i)
            if (freedom[i] == 0) {
                S.row(i).setZero();
                S.col(i).setZero();
                S(i, i) = 1;
            }
        for (int i = 0; i < 12; ++i) S(i, i) *= 1 + kJitter;
        // Of dynamic size: unrolled, these take minutes to compile and are no faster.
        const Eigen::MatrixXcd covariance = S;
        const Eigen::MatrixXcd lower = covariance.llt().matrixL();
        const Eigen::MatrixXcd one = Eigen::MatrixXcd::Identity(12, 12);
        whiteners_.push_back(lower.triangularView<Eigen::Lower>().solve(one));
        for (int i = 0; i < 6; ++i)
            if (freedom[i] == 0) whiteners_.back()(i, i) = 0;  // its equation says nothing
        const Matrix12c& inverse = whiteners_.back();
        regressors_.push_back(PA * inverse.adjoint());
        motions_.push_back(inverse * A);
        load_noises_.push_back(load_covariance * by_load.adjoint() * inverse.adjoint());
        loads_.push_back(inverse * by_load);
        receptances_.push_back(receptance);
        if (b % every != every / 2) continue;
        Sample sample{b, static_cast<double>(every), Eigen::Matrix<std::complex<double>, 15, 15>::Zero()};
        sample.root.topLeftCorner<12, 12>() = calcRoot(P);
        sample.root.bottomRightCorner<3, 3>() = calcRoot(load_covariance.cast<std::complex<double>>());
        samples_.push_back(sample);
    }
}

}  // namespace wems::identify
