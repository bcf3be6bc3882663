#include "identify/exact/whitening.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/fourier.hpp"
#include "identify/problem/mount_equation.hpp"
#include "models/axis_law.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

using Matrix6c = Eigen::Matrix<std::complex<double>, 6, 6>;
using Matrix6x12c = Eigen::Matrix<std::complex<double>, 6, 12>;

constexpr double kRoot2 = 1.4142135623730951;  // real and imaginary parts share the variance
constexpr double kLowest = 2.5;                // Hz: below it there is drift and little else
constexpr double kHighest = 110.0;             // Hz: twice a sweep that ends at 50 Hz
constexpr double kProportional = 5e-4;         // of the forces and of the motion
constexpr double kMemory = 0.25;               // s: of twice integrated errors
constexpr double kSmoothing = 1.0;             // Hz, width of the spectra's smoothing

Matrix6 calcRigidCovariance(const MountModel& model) {
    Matrix6 information = Matrix6::Zero();
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const auto d = calcAxisDirection(model, static_cast<int>(i), a);
            information += d * d.transpose();
        }
    // Held motions are known.
    const Vector6 freedom = calcFreedom(model.body);
    holdMotions(information, freedom, 1);
    Matrix6 covariance = information.inverse();
    holdMotions(covariance, freedom, 0);
    return covariance;
}

double effectiveVariance(double displacement, double acceleration, double w) {
    const double ratio = w * w * displacement / acceleration;  // zero without accelerations
    return displacement * displacement / (1 + ratio * ratio);
}

/// What a stop makes of slow noise is spread over all frequencies, as the stop closes and opens; twice integrated
/// acceleration noise is all slow: 2 h σ² / (3 (2π)⁴ f³) above f.
double integratedVariance(const OpenLoopRun& run, const SlowBalance& slow, double acceleration) {
    const double total = 2 * run.raw_interval * acceleration * acceleration /
                         (3 * std::pow(kTwoPi, 4) * std::pow(std::max(slow.cornerFrequency(), 1.0), 3));
    return total * 0.5 / run.raw_interval / kHighest;
}

/// Noise of a relative displacement as a stop sees it.
double contactVariance(const OpenLoopRun& run, const SlowBalance* slow, double displacement, double acceleration,
                       double w) {
    // A part without accelerometers has nothing that is integrated.
    return slow != nullptr && std::isfinite(acceleration) ? integratedVariance(run, *slow, acceleration)
                                                          : effectiveVariance(displacement, acceleration, w);
}

/// @param freedom of the equations: held motions have none
Matrix6c invertFactor(const Matrix6c& covariance, const Vector6& freedom) {
    Matrix6c regular = freedom.asDiagonal() * covariance * freedom.asDiagonal();
    for (int i = 0; i < 6; ++i) regular(i, i) *= 1 + 1e-9;
    regular.diagonal() += (Vector6::Ones() - freedom).cast<std::complex<double>>();
    const Matrix6c lower = regular.llt().matrixL();
    const Matrix6c inverse = lower.triangularView<Eigen::Lower>().solve(Matrix6c::Identity());
    return freedom.asDiagonal() * inverse;
}

}  // namespace

Whitening::Whitening(const OpenLoopRun& run, const MountModel& model, bool with_bracket)
    : run_(&run), with_bracket_(with_bracket), fourier_(run.sampleCount()) {
    const double spacing = 1 / (fourier_.size() * run.interval);
    if (run.integrated() && run.lowest > 0) slow_ = std::make_unique<SlowBalance>(run, model);
    first_ = static_cast<Eigen::Index>(
        std::ceil(std::max(kLowest, slow_ ? slow_->highestBalanced() : run.lowest) / spacing));
    bins_ = std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>(std::floor(std::min(kHighest, 0.9 * run.pass) / spacing)) - first_ + 1);
    const auto half = static_cast<Eigen::Index>(0.5 * kSmoothing / spacing);
    const double gain = run.raw_interval / run.interval * run.taper.squaredNorm();
    const Matrix6 M = calcMassMatrix(model.body), K = calcStiffnessMatrix(model), C = calcRigidCovariance(model);

    // Each axis' force: its spectrum for the proportional part, its time in contact for the stops' noise.
    std::vector<Eigen::MatrixXd> force_power;
    std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> directions;
    Matrix6 contact = Matrix6::Zero(), contact_folded = Matrix6::Zero();
    Eigen::Matrix<double, 6, 12> relative;
    relative << Matrix6::Identity(), -Matrix6::Identity();
    const Matrix6 folded = relative * run.aliasing * relative.transpose();
    std::vector<char> touched(static_cast<std::size_t>(run.time[run.sampleCount() - 1] / kMemory) + 1, 0);
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const auto c = static_cast<int>(i);
            const AxisLaw& law = model.connections[i].axis[a];
            const auto d = calcAxisDirection(model, c, a);
            force_power.push_back(smoothPower(transform(calcAxisForce(run, law, c, a).transpose()), half));
            directions.push_back(d * d.transpose());
            const AxisForce force(law);
            double square = 0;
            for (int k = 0; k < run.sampleCount(); ++k) {
                const double stop = force.calcStaticStiffness(run.q(3 * c + a, k)) - law.stiffness;
                square += stop * stop / run.sampleCount();
                if (stop != 0) touched[static_cast<std::size_t>(run.time[k] / kMemory)] = 1;
            }
            contact += square * (d.transpose() * C * d)(0) * directions.back();
            contact_folded += square * (d.transpose() * folded * d)(0) * directions.back();
        }
    // What folds comes with contact, when it does most harm.
    contact_folded *= static_cast<double>(touched.size()) /
                      std::max(1.0, static_cast<double>(std::count(touched.begin(), touched.end(), 1)));
    const Eigen::MatrixXd demand_power = smoothPower(transform(calcDemand(run, model.body, model.gravity)), half);
    Eigen::MatrixXd fixed(6, run.sampleCount());
    fixed << run.fixed.p, run.fixed.theta;
    const Eigen::MatrixXd fixed_power = smoothPower(transform(fixed), half);

    const double proportional = kProportional * kProportional;
    for (Eigen::Index b = 0; b < bins_; ++b) {
        const double w = kTwoPi * frequency(b);
        const double mobile = gain * effectiveVariance(run.mobile_noise, run.mobile_acceleration_noise, w);
        const double still = gain * effectiveVariance(run.fixed_noise, run.fixed_acceleration_noise, w);
        const Matrix6 G = K - w * w * M;
        const double touching =
            gain * (contactVariance(run, slow_.get(), run.mobile_noise, run.mobile_acceleration_noise, w) +
                    contactVariance(run, slow_.get(), run.fixed_noise, run.fixed_acceleration_noise, w));
        Matrix6 S = mobile * G * C * G.transpose() + still * K * C * K.transpose() + touching * contact;
        const double twice = gain / (w * w * w * w);
        Eigen::Matrix<double, 6, 12> both;
        both << G, -K;
        S += twice * both * run.aliasing * both.transpose();
        if (slow_) S += gain * integratedVariance(run, *slow_, 1.0) * contact_folded;
        for (std::size_t i = 0; i < directions.size(); ++i) S += proportional * force_power[i](0, b) * directions[i];
        S.diagonal() += proportional * demand_power.col(b);
        factors_[0].push_back(invertFactor(S.cast<std::complex<double>>(), calcFreedom(model.body)));
        if (!with_bracket_) continue;
        Matrix6c T = Matrix6c::Zero();
        for (const auto& mode : model.bracket) {
            const auto shape = calcShape(mode);
            T += calcModalResponse(mode, w) * (shape * shape.transpose()).cast<std::complex<double>>();
        }
        T *= (w * w * M).cast<std::complex<double>>();
        Matrix6c B = mobile * T * C.cast<std::complex<double>>() * T.adjoint();
        B += (still * C).cast<std::complex<double>>();
        Matrix6x12c predicted;
        predicted << T, -Matrix6c::Identity();
        B += twice * predicted * run.aliasing.cast<std::complex<double>>() * predicted.adjoint();
        for (int i = 0; i < 6; ++i) B(i, i) += proportional * fixed_power(i, b);
        factors_[1].push_back(invertFactor(B, Vector6::Ones()));
    }
}

double Whitening::frequency(Eigen::Index bin) const {
    return static_cast<double>(first_ + bin) / (fourier_.size() * run_->interval);
}

Eigen::MatrixXcd Whitening::transform(const Eigen::Ref<const Eigen::MatrixXd>& series) const {
    return fourier_.forward(series * run_->taper.asDiagonal()).middleCols(first_, bins_);
}

Eigen::VectorXcf Whitening::calcSpectrum(const Eigen::Ref<const Eigen::VectorXd>& history) const {
    return transform(history.transpose()).row(0).transpose().cast<std::complex<float>>();
}

Eigen::MatrixXcf Whitening::whitenDirection(Equation equation, const Eigen::Matrix<double, 6, 1>& direction) const {
    const auto& factors = factors_[equation == Equation::mount ? 0 : 1];
    Eigen::MatrixXcf result(6, bins_);
    for (Eigen::Index b = 0; b < bins_; ++b)
        result.col(b) = (kRoot2 * (factors[b] * direction)).cast<std::complex<float>>();
    return result;
}

void addAlong(const Eigen::MatrixXcf& white, const Eigen::VectorXcf& spectrum, Eigen::Ref<Eigen::VectorXf> values) {
    for (Eigen::Index b = 0; b < spectrum.size(); ++b) {
        // Real arithmetic: the complex product of the standard library looks for infinities.
        const float real = spectrum[b].real(), imag = spectrum[b].imag();
        float* out = values.data() + 12 * b;
        for (int i = 0; i < 6; ++i) {
            const std::complex<float> w = white(i, b);
            out[i] += w.real() * real - w.imag() * imag;
            out[6 + i] += w.real() * imag + w.imag() * real;
        }
    }
}

void Whitening::apply(Equation equation, const Eigen::Ref<const Eigen::MatrixXd>& series,
                      Eigen::Ref<Eigen::VectorXf> out) const {
    if (slow_ && equation == Equation::mount) {
        whiten(equation, slow_->balance(series), out);
    } else {
        whiten(equation, series, out);
    }
}

void Whitening::applySlow(const Eigen::Ref<const Eigen::VectorXd>& coefficients,
                          Eigen::Ref<Eigen::VectorXf> out) const {
    whiten(Equation::mount, slow_->calcForces(coefficients), out);
}

void Whitening::whiten(Equation equation, const Eigen::Ref<const Eigen::MatrixXd>& series,
                       Eigen::Ref<Eigen::VectorXf>& out) const {
    const auto& factors = factors_[equation == Equation::mount ? 0 : 1];
    const Eigen::MatrixXcd spectra = transform(series);
    for (Eigen::Index b = 0; b < bins_; ++b) {
        const Eigen::Matrix<std::complex<double>, 6, 1> white = kRoot2 * (factors[b] * spectra.col(b));
        for (int i = 0; i < 6; ++i) {
            out[12 * b + i] = static_cast<float>(white[i].real());
            out[12 * b + 6 + i] = static_cast<float>(white[i].imag());
        }
    }
}

Eigen::VectorXf Whitening::apply(const Eigen::Ref<const Eigen::MatrixXd>& mount,
                                 const Eigen::Ref<const Eigen::MatrixXd>& bracket) const {
    Eigen::VectorXf result = Eigen::VectorXf::Zero(size());
    if (mount.size() > 0) apply(Equation::mount, mount, result.head(mountSize()));
    if (with_bracket_ && bracket.size() > 0) apply(Equation::bracket, bracket, result.tail(mountSize()));
    return result;
}

namespace {

constexpr int kIterations = 20;

Eigen::MatrixXd calcRelative(const RunMotion& run, const MountModel& model) {
    const auto samples = run.mobile.p.cols();
    Eigen::MatrixXd q(3 * model.connections.size(), samples);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const Eigen::Matrix3d R_GM = rotationFromVector(run.mobile.theta.col(k)),
                              R_GF = rotationFromVector(run.fixed.theta.col(k));
        for (std::size_t i = 0; i < model.connections.size(); ++i) {
            const Eigen::Vector3d r = model.connections[i].position;
            q.block<3, 1>(3 * i, k) =
                R_GF.transpose() * (run.mobile.p.col(k) + R_GM * r - run.fixed.p.col(k) - R_GF * r);
        }
    }
    return q;
}

/// Largest mean of `values` over any window of so many samples.
double calcLargestMean(const Eigen::VectorXd& values, Eigen::Index window) {
    double sum = 0, largest = 0;
    for (Eigen::Index k = 0; k < values.size(); ++k) {
        sum += values[k];
        if (k >= window) sum -= values[k - window];
        largest = std::max(largest, sum / static_cast<double>(window));
    }
    return largest;
}

}  // namespace

void restoreSlowMotion(RunMotion& run, const MountModel& model) {
    if (run.mobile.displacement_measured || !(run.trusted_from > 0)) return;
    const Eigen::MatrixXd measured = calcRelative(run, model);
    Eigen::Matrix<double, 6, Eigen::Dynamic> directions(6, measured.rows());
    std::vector<AxisForce> laws;
    for (Eigen::Index i = 0; i < measured.rows(); ++i) {
        const std::size_t connection = i / 3;
        directions.col(i) = calcAxisDirection(model, static_cast<int>(i / 3), static_cast<int>(i % 3));
        laws.emplace_back(model.connections[connection].axis[i % 3]);
    }
    const Fourier fourier(static_cast<int>(measured.cols()));
    const auto slow_bins = std::min<Eigen::Index>(
        fourier.binCount(), static_cast<Eigen::Index>(run.trusted_from * fourier.size() * run.interval) + 1);
    const auto window = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(1 / (run.trusted_from * run.interval)));
    Eigen::MatrixXd acceleration(6, measured.cols());
    acceleration << run.mobile.a, run.mobile.alpha;
    const Eigen::MatrixXd inertia = calcMassMatrix(model.body) * acceleration;
    Eigen::MatrixXd slow = Eigen::MatrixXd::Zero(6, measured.cols());
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        // Steps by a stiffness at least as large as the mean one at any time: they never overshoot.
        Eigen::MatrixXd force = measured + directions.transpose() * slow;
        Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
        Eigen::VectorXd tangent(force.cols());
        for (Eigen::Index i = 0; i < force.rows(); ++i) {
            const auto& law = laws[i];
            for (Eigen::Index k = 0; k < force.cols(); ++k) {
                tangent[k] = std::max(0.0, law.calcStaticStiffness(force(i, k)));
                force(i, k) = law.calcStaticForce(force(i, k));
            }
            stiffness += calcLargestMean(tangent, window) * directions.col(i) * directions.col(i).transpose();
        }
        const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(stiffness);
        if (factor.info() != Eigen::Success) return;
        Eigen::MatrixXcd spectra = fourier.forward(inertia + directions * force);
        spectra.rightCols(spectra.cols() - slow_bins).setZero();
        slow -= factor.solve(fourier.inverse(spectra, static_cast<int>(measured.cols())));
    }
    run.mobile.p += slow.topRows(3);
    run.mobile.theta += slow.bottomRows(3);
    run.notes.emplace_back("mobile part: the displacement below that follows from the balance of the model's forces");
}

}  // namespace wems::identify
