/// @file
/// Covariance of what one run's equations leave, by the noise of its channels.
///
/// With K' the mount's stiffness and damping as small motion meets them in the mean (about M's origin), G = K' − ω²M,
/// T = Φ H Φᵀ ω² M what the mobile part's motion makes of the fixed part's, and P_m, P_f the covariances of the two
/// rigid motions,
///
///     residuals = A (mobile; fixed) + B load,      A = [ G  −K' ; T  −1 ]
///
///     B = [ 0 ; Φ H Φ_Lᵀ ] with the load at the bracket's load point, [ −W ; Φ H Φᵀ W ] with it on the mobile part
///
///     R(ω) = A diag(P_m, P_f) Aᴴ + B S_l Bᴴ + noise of the stops in contact
///
/// W is the wrench of unit loads (mount_equation.hpp); at a point of the fixed part B has Φ H Φᵀ W alone.
///
/// P_m, P_f and S_l hold a discrepancy beside the noise, for what is neither noise nor parameter: a small fraction of
/// the motion's and the load's own spectra, never zero (Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294). Carried
/// through the equations like noise, it scales with the model's forces as they do. That of the load acts along the
/// load: with one across it, participation across the load grew until the prior stopped it, as the misfit falls where R
/// grows.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "identify/motion/fourier.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/slow_balance.hpp"
#include "identify/problem/test_run.hpp"

namespace wems::identify {

using Matrix12c = Eigen::Matrix<std::complex<double>, 12, 12>;

/// The bins of a run's spectra that count, and how its tapered samples become them.
class EquationSpectra {
public:
    /// @param from, to Hz
    EquationSpectra(const OpenLoopRun& run, double from, double to);
    Eigen::Index binCount() const { return bins_; }
    double angular(Eigen::Index bin) const;    ///< rad/s
    double frequency(Eigen::Index bin) const;  ///< Hz
    /// rows x bins, tapered.
    Eigen::MatrixXcd transform(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;
    /// The same of samples x rows.
    Eigen::MatrixXcd transformSamples(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;
    /// 2 Re Σ_b value · exp(iωt) at each sample: what one sample adds to the product with a spectrum.
    Eigen::VectorXd calcSeries(const Eigen::VectorXcd& values) const;
    /// Power that white noise of unit variance in the recording has at a bin.
    double noiseGain() const { return gain_; }
    /// Power at the bins of noise that a factor's history lets through: the factor's power convolved with the noise's.
    /// @param factor at each sample; @param density variance of a sample, as white noise, at all bins of the transform
    ///     (densityFrequency)
    Eigen::VectorXd calcModulated(const Eigen::Ref<const Eigen::RowVectorXd>& factor,
                                  const Eigen::RowVectorXd& density) const;
    Eigen::Index firstBin() const { return first_; }
    Eigen::Index densityCount() const { return fourier_.binCount(); }
    double densityFrequency(Eigen::Index k) const;  ///< Hz
    /// Smoothed power of tapered rows at the bins.
    Eigen::MatrixXd calcPower(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;

private:
    const OpenLoopRun* run_;
    Fourier fourier_;
    Eigen::Index first_ = 0, bins_ = 0;
    double gain_ = 0;
};

/// Noise of the two rigid motions, as displacements, at a frequency: what fusion of displacements and accelerations
/// leaves. Weights of the two in the fused motion.
class MotionNoise {
public:
    /// @param layout with the sensors where the run's readings were corrected to (moveSensors)
    MotionNoise(const TestRun& run, const SensorLayout& layout);
    struct Weights {
        double displacement, acceleration;
    };
    Weights weights(Part part, double w) const;
    /// m², m rad, rad² of one sample's noise, as white noise of the density at w (rad/s).
    Matrix6 covariance(Part part, double w) const;
    /// The same of both parts (mobile above fixed) by what sampling has folded.
    /// @param accelerations covariance as of calcAliasing
    Eigen::Matrix<double, 12, 12> foldedCovariance(const Eigen::Matrix<double, 12, 12>& accelerations, double w) const;

private:
    struct Side {
        bool displacement = false, acceleration = false;
        double ratio = 0;  // σ_x / σ_a of the fusion, s²
        Matrix6 by_displacement = Matrix6::Zero(), by_acceleration = Matrix6::Zero();
        const NoiseDensity *displacement_density = nullptr, *acceleration_density = nullptr;
    };
    Side sides_[2];
};

/// R(ω) and what its dependence on the model needs, at every bin.
class RunNoise {
public:
    RunNoise(const TestRun& test, const OpenLoopRun& run, const MountModel& model, const MotionNoise& motion,
             const EquationSpectra& spectra, const SlowBalance* slow, bool with_bracket);

    Eigen::Index binCount() const { return static_cast<Eigen::Index>(whiteners_.size()); }
    /// Inverse of R's Cholesky factor at a bin; rows and columns from 6 on belong to the bracket.
    const Matrix12c& whitener(Eigen::Index bin) const { return whiteners_[bin]; }
    /// With L⁻¹ the whitener: P Aᴴ L⁻ᴴ (rows mobile above fixed part) and L⁻¹ A at a bin.
    const Matrix12c& regressorNoise(Eigen::Index bin) const { return regressors_[bin]; }
    const Matrix12c& whitenedMotion(Eigen::Index bin) const { return motions_[bin]; }
    /// S_l Bᴴ L⁻ᴴ at a bin, S_l the load's noise.
    const Eigen::Matrix<std::complex<double>, 3, 12>& loadNoise(Eigen::Index bin) const { return load_noises_[bin]; }
    /// L⁻¹ B at a bin: what unit loads along the axes make of the equations.
    const Eigen::Matrix<std::complex<double>, 12, 3>& whitenedLoad(Eigen::Index bin) const { return loads_[bin]; }
    /// Φ H Φᵀ at a bin.
    const Eigen::Matrix<std::complex<double>, 6, 6>& receptance(Eigen::Index bin) const { return receptances_[bin]; }

    /// The noise of the motions (mobile above fixed part) and the load (P above) at some of the bins, for sums that
    /// need not all.
    struct Sample {
        Eigen::Index bin;
        double weight;                                     ///< bins that it stands for
        Eigen::Matrix<std::complex<double>, 15, 15> root;  ///< root rootᴴ = P
    };
    const std::vector<Sample>& samples() const { return samples_; }

    /// Variance of a tapered sample of an axis' relative displacement, as a stop's stiffness meets it, m².
    double contactVariance(std::size_t axis) const { return contact_variances_[axis]; }
    /// Power at each bin of the force that the noise makes of an axis' stiffness beyond its mean, N².
    Eigen::RowVectorXd contactPower(Eigen::Index axis) const { return contact_power_.row(axis); }

private:
    template <typename T>
    using Aligned = std::vector<T, Eigen::aligned_allocator<T>>;
    Aligned<Matrix12c> whiteners_, regressors_, motions_;
    Aligned<Eigen::Matrix<std::complex<double>, 6, 6>> receptances_;
    Aligned<Eigen::Matrix<std::complex<double>, 3, 12>> load_noises_;
    Aligned<Eigen::Matrix<std::complex<double>, 12, 3>> loads_;
    Eigen::MatrixXd contact_power_;  // axes x bins
    std::vector<double> contact_variances_;
    std::vector<Sample> samples_;
};

}  // namespace wems::identify
