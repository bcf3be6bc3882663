/// @file
/// Small errors everywhere: tolerances of a level, and a model drawn within them.
#pragma once

#include "models/mount_model.hpp"
#include "tests/hidden/random_numbers.hpp"

namespace wems::hidden {

/// Level 2 has these ± values, level 1 half of them, level 0 none. Relative where no unit is given.
struct SmallErrors {
    double share = 1;  ///< of those of level 2
    double mass = 0.005, center_of_gravity = 1e-3 /* m */, inertia = 0.03;
    double stiffness = 0.05, damping = 0.25, clearance = 0.03, stop_stiffness = 0.08;
    double position = 5e-4;  // m
    double mode_frequency = 0.01, mode_damping_ratio = 0.25, mode_shape = 0.03;
    double load_gain = 0.005, load_noise = 0.002;
    double sensor_gain = 0.005, sensor_rotation = 8.7e-3 /* rad */, sensor_position = 5e-4 /* m */;
    double sensor_delay = 2e-5;  // s in unit time; what the AC coupling looks like
};
/// @param level 0, 1 or 2
SmallErrors makeSmallErrors(int level);

/// Every number of the device off by at most its tolerance, uniformly drawn.
MountModel drawBelieved(const MountModel& exact, const SmallErrors& errors, Random& random);

/// As the believed model states them; of a device that is slower by `time_scale`.
Tolerances stateTolerances(const SmallErrors& errors, double time_scale);

}  // namespace wems::hidden
