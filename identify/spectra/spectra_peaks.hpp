/// @file
/// Resonances in a frequency response.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems::identify {

struct ResponsePeak {
    Eigen::Index bin = 0;
    double frequency = 0;      ///< Hz
    double amplitude = 0;      ///< |H|
    double damping_ratio = 0;  ///< from the half-power width, Δf/(2 f); NaN where a side does not fall by 3 dB first
};

/// Local maxima of |H| within [from, to] (Hz), largest first, that stand out: from each, |H| falls by 3 dB to at least
/// one side and by 1 dB to the other before it rises above it again. Frequency and amplitude by the parabola through
/// the three bins in log |H|.
std::vector<ResponsePeak> findPeaks(const Eigen::VectorXd& frequency, const Eigen::VectorXd& amplitude, double from,
                                    double to);

}  // namespace wems::identify
