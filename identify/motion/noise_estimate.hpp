/// @file
/// Noise of one channel, from what a rigid motion leaves of many.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems::identify {

// Robust location and scatter: the middle value, and the middle deviation from it.

/// The upper middle of `values` (not empty; taken by value because it is partly sorted).
double median(std::vector<double> values);
/// Standard deviation of a normal variable with the median absolute deviation of `values` from `centre`.
double medianDeviation(const std::vector<double>& values, double centre);

/// RMS noise of a channel from the residuals of a rigid fit (channels x samples) with `redundancy` ≥ 1 equations more
/// than unknowns. Second differences keep systematic residuals (gains, flexibility) at the frequencies of the motion
/// out, the median over samples keeps bursts (contact) out; white noise is assumed. Median of χ²: exact for Gaussian
/// noise.
double estimateNoiseFromResiduals(const Eigen::MatrixXd& residuals, int redundancy);

/// RMS noise of a signal from its sixth differences alone (no redundancy); robust, but content of the signal above a
/// tenth of the sampling rate counts as noise.
double estimateNoiseFromSignal(const Eigen::VectorXd& signal);

/// Integrated autocorrelation 1 + 2 Σ ρ_k of a residual, up to where it falls below 0.05; in samples.
double calcCorrelationLength(const Eigen::VectorXd& residual);

}  // namespace wems::identify
