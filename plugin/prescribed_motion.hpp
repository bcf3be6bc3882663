/// @file
/// `simulate --motion`: the laws of a model along a recorded relative motion, as a test machine prescribes it.
#pragma once

#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {

/// What one axis of a connection did.
struct PrescribedAxis {
    std::string connection;
    int axis = 0;
    double largest_displacement = 0;  ///< m, absolute
    double largest_force = 0;         ///< N, absolute
    double energy_put_in = 0;         ///< J, work done on the law, trapezoids; what springs hold at the end included
};

/// The component test that a model would give: time, `relative.<connection>.<q>` and `force.<connection>.<q>`.
struct PrescribedRun {
    Recording recording;
    std::vector<PrescribedAxis> axes;
};

/// Along the relative displacements that `motion` holds (`relative.…`, or mobile minus fixed), with its velocities or
/// those that follow from them. A model with one connection takes a recording of one connection of any name.
/// @throws InputError: no displacement of a connection of the model.
PrescribedRun followMotion(const MountModel& model, const Recording& motion);

/// Computes, prints and writes what was asked for. @throws InputError
void runPrescribedMotion(const SimulateOptions& options);

}  // namespace wems::plugin
