/// @file
/// What sampling and low-pass filtering make of a motion with contacts.
#pragma once

#include <Eigen/Core>
#include <array>

#include "identify/motion/motion.hpp"

namespace wems::identify {

// What contact hides in sampled accelerations.
//
// A stop that closes or opens bends the acceleration: its spectrum falls with 1 / f² beyond the sampling rate f_s, and
// what was sampled without a filter folds back. Near f = 0 there is then Σ_n (n f_s)⁻⁴ = 2.16 f_s⁻⁴ in place of
// nothing, white; between 0.4 and 0.5 f_s, where it can be seen, 36 f_s⁻⁴. Integrated twice it is the largest error of
// a displacement. It moves all channels as a rigid motion does, so that no redundancy shows it. Behind a filter that
// suits the sampling rate nothing is seen there, and nothing folds.

/// Covariance of (a, alpha) of the mobile part above those of the fixed part by folding at low frequencies, as white
/// noise up to half the sampling rate; m²/s⁴ and so on. One contact bends both: they belong together. Zero for a part
/// whose accelerations were not measured; what the channels' noise has there is left out.
Eigen::Matrix<double, 12, 12> calcAliasing(const RunMotion& run);

// Low-pass filtering with exactly matching derivatives: a compact test function and its first two derivatives.

/// Windowed sinc h with h' and h''; the window cos⁶ ends with five derivatives, so that none of the three jumps.
/// Convolution with h, h' and h'' gives the smoothed signal and its derivatives, all of the same signal: an equation of
/// motion that holds for the signal holds for them (weak form, the derivatives moved onto the test function). Zero
/// phase.
class SmoothingKernel {
public:
    SmoothingKernel() = default;
    /// @param interval s between samples; @param pass, stop edges of the transition band (Hz), stop ≤ 1 / (2 interval)
    SmoothingKernel(double interval, double pass, double stop);

    /// Samples on each side of the middle; results closer than this to an end rest on held values.
    int halfWidth() const { return half_width_; }

    /// Derivative (0, 1 or 2) of each smoothed row, every `step`-th sample: rows x ceil(samples / step). Beyond the
    /// ends the signal is held.
    Eigen::MatrixXd apply(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative, int step) const;
    /// The same at `refinement` places in each interval of rows that are as many intervals of the kernel apart.
    /// @pre the transition band ends below half of the rows' rate
    Eigen::MatrixXd applyBetween(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative, int refinement) const;

    /// What is left of a sine. @param frequency of the kernel's rate
    double calcResponse(double frequency) const;

private:
    int half_width_ = 0;
    std::array<Eigen::VectorXd, 3> weights_;  // correlation weights from -half_width to +half_width
};

}  // namespace wems::identify
