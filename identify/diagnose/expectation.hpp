/// @file
/// What a perfect model would leave in the recordings, by doing the same to recordings that the model itself gives.
///
/// No fixed misfit is right for every law: friction leaves more than noise even where all is known, and so does what
/// contact folds into sampled accelerations. So the model is simulated, given noise and calibration scatter of the
/// recording's size, and judged as the recording is. The free simulation's error is that of one draw of the scatter,
/// which contact may amplify a thousand times, another time more or less; the misfit is not amplified.
#pragma once

#include <vector>

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

struct Expectation {
    double error = 0;   ///< of the free simulation, as calcFreeError
    double misfit = 1;  ///< of the equations of motion, per value
};

/// @param base  the model that motions are recovered with
/// @param model the one that is judged
/// @return infinite if the simulation diverges: then nothing can be said against the model
Expectation calcExpectation(const std::vector<RunMotion>& runs, const MountModel& base, const MountModel& model);

}  // namespace wems::identify
