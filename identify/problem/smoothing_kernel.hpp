/// @file
/// Low-pass filtering with exactly matching derivatives: a compact test function and its first two derivatives.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

/// Windowed sinc h with h' and h''; the window cos⁶ ends with five derivatives, so that none of the three jumps.
/// Convolution with h, h' and h'' gives the smoothed signal and its derivatives, all of the same signal: an equation of
/// motion that holds for the signal holds for them (weak form, the derivatives moved onto the test function). Zero
/// phase.
class SmoothingKernel {
public:
    /// @param interval s between samples; @param pass, stop edges of the transition band (Hz), stop ≤ 1 / (2 interval)
    SmoothingKernel(double interval, double pass, double stop);

    /// Samples on each side of the middle; results closer than this to an end rest on held values.
    int halfWidth() const { return half_width_; }

    /// Derivative (0, 1 or 2) of each smoothed row, every `step`-th sample: rows x ceil(samples / step). Beyond the
    /// ends the signal is held.
    Eigen::MatrixXd apply(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative, int step) const;

private:
    int half_width_ = 0;
    Eigen::VectorXd weights_[3];  // correlation weights from -half_width to +half_width
};

}  // namespace wems::identify
