/// @file
/// Frequency response functions from spectral densities, with coherence and intervals.
#pragma once

#include <Eigen/Core>

#include "identify/spectra/welch.hpp"

namespace wems::identify {

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

}  // namespace wems::identify
