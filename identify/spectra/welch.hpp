/// @file
/// Spectral densities of several signals and their cross densities with one of them, by Welch's method.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

/// Segments with a periodic Hann window, each freed from its mean, half overlapping.
struct WelchSettings {
    Eigen::Index segment = 1024;  ///< samples
};

struct CrossSpectra {
    Eigen::VectorXd frequency;  ///< Hz, from 0 to half the sampling rate
    Eigen::MatrixXd density;    ///< bins x signals, one-sided, unit²/Hz
    Eigen::MatrixXcd cross;     ///< bins x signals: mean of conj(R) Y, R the reference; one-sided
    Eigen::Index reference = 0;
    Eigen::Index segments = 0;
    /// Of each density: 2 K for K independent segments, less by what neighbours share. Source: Welch (1967),
    /// doi:10.1109/TAU.1967.1161901.
    double degrees_of_freedom = 0;
    double resolution = 0;  ///< Hz, from one bin to the next
};

/// The definitions of SciPy's `welch`, `csd` and `coherence` with their defaults but for the segment.
/// @param signals one column each @param reference column that the others are crossed with
/// @param interval s between samples
/// @throws InputError if the segment is longer than the signals or shorter than 8 samples
CrossSpectra estimateSpectra(const Eigen::MatrixXd& signals, Eigen::Index reference, double interval,
                             const WelchSettings& settings);

/// The power of two that gives at least `averages` half-overlapping segments, at least 8 samples.
Eigen::Index chooseSegment(Eigen::Index samples, int averages);

// Frequency response functions from spectral densities, with coherence and intervals.

/// Y = H X, estimated at each bin. With noise on y alone H1 is unbiased, with noise on x alone H2; |H1| ≤ |Hv| ≤ |H2|.
struct TransferEstimate {
    Eigen::VectorXcd h1;  ///< S_xy/S_xx
    Eigen::VectorXcd h2;  ///< S_yy/S_yx
    /// Both signals noisy in proportion to their own density: phase of S_xy, size √(S_yy/S_xx), which is the total
    /// least squares solution with both scaled to the same density. Source: Rocklin, Crowley, Vold (IMAC III, 1985).
    Eigen::VectorXcd hv;
    Eigen::VectorXd coherence;  ///< γ² = |S_xy|²/(S_xx S_yy), 0 to 1
    /// With 95 % the true H lies in the circle of this radius around h1, where x is free of noise:
    /// r² = (0.05^(−2/(ν−2)) − 1) (1 − γ²) S_yy/S_xx, ν the degrees of freedom, which is the F distribution's quantile
    /// in closed form. Infinite for ν ≤ 2. Source: Bendat, Piersol, Random Data (2010), eq. 6.145 ff.
    Eigen::VectorXd radius95;
};

/// From the reference of `spectra` to its column `output`.
TransferEstimate estimateTransfer(const CrossSpectra& spectra, Eigen::Index output);

/// Coherence that two unrelated signals exceed in 5 % of bins: 1 − 0.05^(2/(ν−2)).
double coherenceThreshold95(double degrees_of_freedom);

// Quantiles that intervals of spectra need.

/// x with P(χ²_ν ≤ x) = p, to 1e-12. @param degrees_of_freedom above 0 @param p within (0, 1)
double chiSquareQuantile(double degrees_of_freedom, double p);

/// The factors by which a 95 % interval of a spectral density lies below and above its estimate: ν/χ²_{0.975} and
/// ν/χ²_{0.025}. Source: Bendat, Piersol, Random Data (2010), eq. 8.159.
struct DensityInterval {
    double lower, upper;
};
DensityInterval densityInterval95(double degrees_of_freedom);

}  // namespace wems::identify
