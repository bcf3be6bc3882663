/// @file
/// The slow displacement that accelerations cannot show, from the balance of forces.
#pragma once

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Below the band where accelerations can be integrated twice they still say what force they take. A stop reached on
/// one side pushes the mean of the motion away from it; integrated accelerations miss that, which shifts every
/// clearance. Adds to the mobile part the slow motion x that solves
///
///     [ M a + Σ d_i f_i(q_i + d_iᵀ x) ]_slow = 0        (d_i as calcAxisDirection, small rotations)
///
/// with mass and laws of `model`. Does nothing where the mobile part's displacements were measured.
void restoreSlowMotion(RunMotion& run, const MountModel& model);

}  // namespace wems::identify
