/// @file
/// The slow part of the motion of a run that was recorded as accelerations alone.
///
/// Displacements integrated from accelerations say nothing below `trusted_from`: neither the shift of the mean position
/// that unequal clearances cause as long as stops are hit, nor slow transients. Below that frequency the inertia force
/// is measured, and the mount's force must balance it. With w(t) the wrench about Mo that the equation of motion leaves
/// unbalanced, L a low pass and K(t) the mount's mean stiffness, contact included, each pass moves the mobile part by
///
///     s = −K⁻¹ L[w],      p += s_p,      θ += s_θ,
///
/// a Newton step for L[w] = 0. The law's parameters come from a fit; fit and motion are improved in turn.
#pragma once

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// True if the displacements of the run are integrated accelerations.
bool lacksSlowMotion(const RunMotion& motion);

/// Cuts off the end of a run that lacks its slow motion. Its accelerations were continued by zeros for integration, so
/// that the high pass rings there, as wide as the motion itself; the beginning is at rest.
void cutRinging(RunMotion& motion);

/// One pass: moves the mobile part of `motion` so that the mount's force balances the inertia force below the band in
/// which its displacements are trusted. Returns the RMS change of the relative displacements over all connections, m.
double updateSlowOffset(RunMotion& motion, const MountModel& model);

}  // namespace wems::identify
