/// @file
/// What the model says about the applied load: applied = gain(f) · axis_gain · recorded, f the swept frequency.
#pragma once

#include "models/mount_model.hpp"

namespace wems {

/// The gain (-) that all axes have in common at a swept frequency (Hz): linear between the rows of the table, constant
/// outside; a single row holds at every frequency, also where the frequency is not known (NaN). 1 if the table is
/// empty.
double calcLoadGain(const LoadCorrection& correction, double frequency);

/// The gain of each axis (-) at a swept frequency (Hz).
Eigen::Vector3d calcLoadGains(const LoadCorrection& correction, double frequency);

/// True if the gain depends on frequency, so that a swept frequency must be known.
bool dependsOnFrequency(const LoadCorrection& correction);

}  // namespace wems
