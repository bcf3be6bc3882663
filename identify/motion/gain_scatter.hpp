/// @file
/// How exactly the channels of a part are calibrated: what a rigid motion leaves of them tells.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/channel_set.hpp"

namespace wems::identify {

/// Channels of one kind (displacement or acceleration) of a part, and the scatter of their gains.
struct Calibration {
    std::vector<std::string> channels;
    Eigen::MatrixXd design;   ///< channels x 6: channel = row · (motion of the origin, rotation vector) at rest
    double gain_scatter = 0;  ///< standard deviation of the gains about 1; 0 where noise alone explains the residuals
};

/// With H the projection on the rigid motions, gains 1 + g_c leave (I − H) diag(s) g of the signals s. From the normal
/// equations of g, in the directions that noise does not hide, the variance of g by the method of moments.
/// @param residuals of the rigid fit, channels x samples
/// @param noise RMS of one channel
Calibration estimateCalibration(const ChannelSet& set, const Eigen::MatrixXd& residuals, double noise);

}  // namespace wems::identify
