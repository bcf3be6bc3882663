/// @file
/// What a perfect model would leave in the recordings, by doing the same to recordings that the model itself gives.
///
/// No fixed misfit is right for every law: friction leaves more than noise even where all is known, and so does what
/// contact folds into sampled accelerations. So the model is simulated, given noise and calibration scatter of the
/// recording's size, and judged as the recording is. The free simulation's error is that of one draw of the scatter,
/// which contact may amplify a thousand times, another time more or less; the misfit is not amplified.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/exact/catalogue.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// The recording that a model would have given: the drive of a measured run, noise and calibration of its size.

struct SimulatedNoise {
    double sign = 1;          ///< of the noise that the run shows, ±1: the same draw with both signs; 0 for none
    double gain_scatter = 0;  ///< standard deviation of each channel's gain, the load's included
};

/// What `model` would have given at all its connections, of the kinds that were recorded, at the times of `run`.
/// Motions of `run` are its own, so that faults of channels, which were corrected, do not return.
/// @throws SimulationDiverged
Recording simulateRecording(const RunMotion& run, const MountModel& model, const SimulatedNoise& noise);

// The bias of a fit, by doing the same to simulated recordings.
//
// The equations are evaluated along the measured motion, so that noise, sampling and smoothing enter their regressors
// too: products of noisy quantities, as in a stop's dissipation k δ χ δ', do not average out, and a least-squares
// fit is biased. The bias is measured: the fitted model is simulated with the recorded drive and sampled like the
// recording, noise of the recording's size is added, and the same steps fit it again. What comes out minus what was
// put in is the bias (parametric bootstrap; Efron and Tibshirani, An Introduction to the Bootstrap, 1993, chapter 10).
// Two simulated recordings with opposite noise leave nothing of first order in it.

/// Bias of the values of the knobs, in their order; zeros if a simulation diverges.
/// @param base  the model that motions are recovered with
/// @param model the fitted one
Eigen::VectorXd calcFitBias(const std::vector<RunMotion>& runs, const MountModel& base, const MountModel& model,
                            const std::vector<Knob>& knobs);

struct Expectation {
    double error = 0;   ///< of the free simulation, as calcFreeError
    double misfit = 1;  ///< of the equations of motion, per value
};

/// @param base  the model that motions are recovered with
/// @param model the one that is judged
/// @return infinite if the simulation diverges: then nothing can be said against the model
Expectation calcExpectation(const std::vector<RunMotion>& runs, const MountModel& base, const MountModel& model);

}  // namespace wems::identify
