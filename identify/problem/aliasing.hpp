/// @file
/// What contact hides in sampled accelerations.
///
/// A stop that closes or opens bends the acceleration: its spectrum falls with 1 / f² beyond the sampling rate f_s, and
/// what was sampled without a filter folds back. Near f = 0 there is then Σ_n (n f_s)⁻⁴ = 2.16 f_s⁻⁴ in place of
/// nothing, white; between 0.4 and 0.5 f_s, where it can be seen, 36 f_s⁻⁴. Integrated twice it is the largest error of
/// a displacement. It moves all channels as a rigid motion does, so that no redundancy shows it. Behind a filter that
/// suits the sampling rate nothing is seen there, and nothing folds.
#pragma once

#include <Eigen/Core>

#include "identify/motion/motion.hpp"

namespace wems::identify {

/// Covariance of (a, alpha) of the mobile part above those of the fixed part by folding at low frequencies, as white
/// noise up to half the sampling rate; m²/s⁴ and so on. One contact bends both: they belong together. Zero for a part
/// whose displacements were measured.
Eigen::Matrix<double, 12, 12> calcAliasing(const RunMotion& run);

}  // namespace wems::identify
