/// @file
/// The bias of a fit, by doing the same to simulated recordings.
///
/// The equations are evaluated along the measured motion, so that noise, sampling and smoothing enter their regressors
/// too: products of noisy quantities, as in a stop's dissipation k δ χ δ', do not average out, and a least-squares
/// fit is biased. The bias is measured: the fitted model is simulated with the recorded drive and sampled like the
/// recording, noise of the recording's size is added, and the same steps fit it again. What comes out minus what was
/// put in is the bias (parametric bootstrap; Efron and Tibshirani, An Introduction to the Bootstrap, 1993, chapter 10).
/// Two simulated recordings with opposite noise leave nothing of first order in it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/diagnose/knob.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Bias of the values of the knobs, in their order; zeros if a simulation diverges.
/// @param base  the model that motions are recovered with
/// @param model the fitted one
Eigen::VectorXd calcFitBias(const std::vector<RunMotion>& runs, const MountModel& base, const MountModel& model,
                            const std::vector<Knob>& knobs);

}  // namespace wems::identify
