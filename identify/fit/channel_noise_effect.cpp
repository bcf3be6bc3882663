#include "identify/fit/channel_noise_effect.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "identify/fit/linear_response.hpp"
#include "identify/motion/fourier.hpp"
#include "identify/motion/fusion.hpp"
#include "identify/motion/parallel.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Matrix6x = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// L with L Lᵀ = covariance, which may be singular (a guided device).
Matrix6d calcRoot(const Matrix6d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(covariance);
    return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Noise of one part's motion.
class PartNoise {
public:
    PartNoise(const PartMotion& part, double interval, double trusted_from)
        : part_(part),
          interval_(interval),
          trusted_from_(trusted_from),
          fourier_(static_cast<int>(part.p.cols())),
          displacement_root_(calcRoot(part.displacement_covariance)),
          acceleration_root_(calcRoot(part.acceleration_covariance)) {
        if (part.fusion_weights.cols() > 0)
            for (Eigen::Index i = 0; i < 6; ++i)
                fusion_.emplace_back(part.fusion_weights.row(i).transpose().cast<double>(), interval);
    }

    /// Variance that the noise makes of an influence.
    /// @param motion, accelerations 6 x samples: of the motion, and of its accelerations where they were measured
    double calcVariance(Matrix6x motion, Matrix6x accelerations) const {
        for (std::size_t i = 0; i < fusion_.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            Eigen::VectorXd own = motion.row(row).transpose();
            accelerations.row(row) += fusion_[i].apply(own).transpose();
            motion.row(row) = own.transpose();
        }
        double variance = 0;
        if (part_.displacement_measured)
            variance += calcVariance(displacement_root_.transpose() * motion, part_.displacement_density);
        if (!part_.acceleration_measured) return variance;
        if (!part_.displacement_measured) accelerations += integrateTwice(motion);
        return variance + calcVariance(acceleration_root_.transpose() * accelerations, part_.acceleration_density);
    }

private:
    double calcVariance(const Matrix6x& influence, const NoiseDensity& density) const {
        const Eigen::RowVectorXd power = fourier_.forward(influence).colwise().squaredNorm();
        double sum = 0;
        for (Eigen::Index b = 0; b < power.size(); ++b)
            sum += (b == 0 || 2 * b == fourier_.size() ? 1 : 2) * power[b] * density.at(frequencyOf(b));
        return sum / fourier_.size();
    }

    /// Integrated accelerations are known from a frequency on.
    Matrix6x integrateTwice(const Matrix6x& influence) const {
        Eigen::MatrixXcd spectra = fourier_.forward(influence);
        for (Eigen::Index b = 0; b < spectra.cols(); ++b) {
            const double f = frequencyOf(b);
            spectra.col(b) *= b > 0 && f >= trusted_from_ ? -1 / std::pow(kTwoPi * f, 2) : 0.0;
        }
        return fourier_.inverse(spectra, static_cast<int>(influence.cols()));
    }

    double frequencyOf(Eigen::Index bin) const { return static_cast<double>(bin) / (fourier_.size() * interval_); }

    const PartMotion& part_;
    double interval_, trusted_from_;
    Fourier fourier_;
    Matrix6d displacement_root_, acceleration_root_;
    std::vector<FusionAdjoint> fusion_;
};

class RunEffect {
public:
    RunEffect(const RunMotion& motion, const MountModel& model, const RunEquations& equations)
        : equations_(equations),
          samples_(static_cast<Eigen::Index>(motion.time.size())),
          accelerations_(motion.mobile.acceleration_measured),
          mobile_(motion.mobile, motion.interval, motion.trusted_from),
          fixed_(motion.fixed, motion.interval, motion.trusted_from) {
        const LinearResponse linear = makeLinearResponse(motion, model);
        mass_ = linear.mass;
        dashpots_ = linear.directions * linear.damping.asDiagonal() * linear.directions.transpose();
        stiffness_.resize(motion.time.size());
        for (std::size_t k = 0; k < stiffness_.size(); ++k)
            stiffness_[k] = linear.directions * linear.tangent.col(static_cast<Eigen::Index>(k)).asDiagonal() *
                            linear.directions.transpose();
    }

    /// @param scores 6 x outputs: influence of the equations at each output on the parameter
    double calcVariance(const Matrix6x& scores) const {
        const TestFunction& test_function = equations_.test_function;
        const Matrix6x at_samples = spread(scores, test_function.value());
        Matrix6x by_laws = -dashpots_ * spread(scores, test_function.first());
        for (Eigen::Index k = 0; k < by_laws.cols(); ++k)
            by_laws.col(k).noalias() += stiffness_[static_cast<std::size_t>(k)] * at_samples.col(k);
        const Matrix6x body = mass_ * (accelerations_ ? at_samples : spread(scores, test_function.second()));
        const Matrix6x none = Matrix6x::Zero(6, samples_);
        return (accelerations_ ? mobile_.calcVariance(by_laws, body) : mobile_.calcVariance(by_laws + body, none)) +
               fixed_.calcVariance(by_laws, none);
    }

private:
    /// What an average with these taps takes of each sample: 6 x samples.
    Matrix6x spread(const Matrix6x& scores, const std::vector<double>& taps) const {
        Matrix6x result = Matrix6x::Zero(6, samples_);
        for (Eigen::Index n = 0; n < scores.cols(); ++n) {
            Eigen::Index k = n * equations_.test_function.stride();
            for (const double tap : taps) result.col(k++) += tap * scores.col(n);
        }
        return result;
    }

    const RunEquations& equations_;
    Matrix6d mass_, dashpots_;
    std::vector<Matrix6d> stiffness_;  // at each sample
    Eigen::Index samples_;
    bool accelerations_;
    PartNoise mobile_, fixed_;
};

}  // namespace

Eigen::VectorXd calcChannelNoiseVariances(const Solver& solver, const LinearSystem& system) {
    const Eigen::Index count = system.scale.size();
    Eigen::VectorXd variances = Eigen::VectorXd::Zero(count);
    for (std::size_t r = 0; r < solver.runCount(); ++r) {
        const RunEffect effect(solver.motions()[r], solver.model(), solver.equations().runs()[r]);
        const RowMatrix influence = solver.equations().apply(r, solver.makeSensitivityColumns(system) * system.inverse);
        const Matrix6d back = solver.equations().whitening(r).transpose();
        runParallel(static_cast<std::size_t>(count), [&](std::size_t j) {
            const Eigen::VectorXd column = influence.col(static_cast<Eigen::Index>(j));
            variances[static_cast<Eigen::Index>(j)] +=
                effect.calcVariance(back * Eigen::Map<const Matrix6x>(column.data(), 6, column.size() / 6));
        });
    }
    return variances;
}

}  // namespace wems::identify
