/// @file
/// Residuals of the open-loop equations in units of their own noise: what a perfect model leaves is then known.
///
/// A residual (6 x samples) is tapered, transformed, and each frequency's six values are multiplied by the inverse
/// Cholesky factor of their covariance, so that noise alone gives independent values of unit variance. With M, K the
/// mass and stiffness matrices of the mount (about M's origin), C_m, C_f the covariances of the rigid motions that the
/// channels' noise gives, T(ω) = Φ H(ω) Φᵀ ω² M:
///
///     mount:    S = (K − ω² M) C_m (K − ω² M)ᵀ + K C_f Kᵀ + noise of the stops in contact + proportional part
///     bracket:  S = C_f + T C_m Tᴴ + proportional part
///
/// The proportional part stands for what is neither noise nor fault (calibration, discretisation): a small fraction of
/// the spectrum of the forces, and of the motion, themselves.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "identify/motion/motion.hpp"
#include "identify/problem/fourier.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/slow_balance.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

enum class Equation { mount, bracket };

class Whitening {
public:
    /// @param with_bracket whether the bracket's equation is part of it
    Whitening(const OpenLoopRun& run, const MountModel& model, bool with_bracket);

    /// Values of apply(): 12 for each frequency and equation.
    Eigen::Index size() const { return bins_ * 12 * (with_bracket_ ? 2 : 1); }
    Eigen::Index mountSize() const { return bins_ * 12; }
    Eigen::Index binCount() const { return bins_; }
    double frequency(Eigen::Index bin) const;  ///< Hz

    /// Whitened values: mount first, then bracket; an empty matrix counts as zero.
    Eigen::VectorXf apply(const Eigen::Ref<const Eigen::MatrixXd>& mount,
                          const Eigen::Ref<const Eigen::MatrixXd>& bracket) const;
    /// Of one equation alone, mountSize() values.
    void apply(Equation equation, const Eigen::Ref<const Eigen::MatrixXd>& series,
               Eigen::Ref<Eigen::VectorXf> out) const;

    /// Where the slow motion was not measured; nullptr elsewhere. apply() balances the mount's residual by it.
    const SlowBalance* slowBalance() const { return slow_.get(); }
    /// What a slow motion adds to the mount's equation, whitened: mountSize() values.
    void applySlow(const Eigen::Ref<const Eigen::VectorXd>& coefficients, Eigen::Ref<Eigen::VectorXf> out) const;

    /// Spectrum of a history at the bins of the whitened values, as apply() takes it (tapered).
    Eigen::VectorXcf calcSpectrum(const Eigen::Ref<const Eigen::VectorXd>& history) const;
    /// What has a fixed direction, with unit spectrum, whitened: 6 x bins.
    Eigen::MatrixXcf whitenDirection(Equation equation, const Eigen::Matrix<double, 6, 1>& direction) const;

    /// Factors of the mount's part (inverse Cholesky factor at a bin).
    const Eigen::Matrix<std::complex<double>, 6, 6>& mountFactor(Eigen::Index bin) const { return factors_[0][bin]; }

private:
    using Matrix6c = Eigen::Matrix<std::complex<double>, 6, 6>;
    void whiten(Equation equation, const Eigen::Ref<const Eigen::MatrixXd>& series,
                Eigen::Ref<Eigen::VectorXf>& out) const;
    Eigen::MatrixXcd transform(const Eigen::Ref<const Eigen::MatrixXd>& series) const;

    const OpenLoopRun* run_;
    bool with_bracket_;
    Fourier fourier_;
    std::unique_ptr<SlowBalance> slow_;
    Eigen::Index first_ = 0, bins_ = 0;
    std::vector<Matrix6c, Eigen::aligned_allocator<Matrix6c>> factors_[2];
};

/// Adds to whitened values what has a whitened direction (6 x bins) and a spectrum.
void addAlong(const Eigen::MatrixXcf& white, const Eigen::VectorXcf& spectrum, Eigen::Ref<Eigen::VectorXf> values);

// The slow displacement that accelerations cannot show, from the balance of forces.

/// Below the band where accelerations can be integrated twice they still say what force they take. A stop reached on
/// one side pushes the mean of the motion away from it; integrated accelerations miss that, which shifts every
/// clearance. Adds to the mobile part the slow motion x that solves
///
///     [ M a + Σ d_i f_i(q_i + d_iᵀ x) ]_slow = 0        (d_i as calcAxisDirection, small rotations)
///
/// with mass and laws of `model`. Does nothing where the mobile part's displacements were measured.
void restoreSlowMotion(RunMotion& run, const MountModel& model);

}  // namespace wems::identify
