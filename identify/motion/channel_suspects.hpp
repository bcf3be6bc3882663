/// @file
/// Which channel of a rigid part does not measure what the others say: wrong gain, delay, exchanged channels.
///
/// With d = J x + n for m channels of a rigid motion x (6), the rigid fit leaves e = (I − H) d, H = J (JᵀJ)⁻¹ Jᵀ.
/// Leaving channel c out, the others predict s_c = d_c − e_c/(1 − h_cc). Each hypothesis takes a part of Σ|e|² away:
///
/// - gain: d_c = g s_c; g by least squares, corrected for the noise of s_c;
/// - delay: d_c(t) = s_c(t − τ), to first order d_c − s_c = −τ s_c';
/// - exchange: two channels carry each other's names.
///
/// A channel is named only if its hypothesis takes away at least half of what exceeds the noise, is at least six
/// standard errors from none, and changes the channel by 0.5 % or more (what calibrations commonly leave). Then it is
/// corrected and the search goes on with what remains.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/rigid_fit.hpp"

namespace wems::identify {

// How exactly the channels of a part are calibrated: what a rigid motion leaves of them tells.

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

struct ChannelSuspect {
    std::string channel;                    ///< `mobile.2.z`
    std::string fault;                      ///< `gain`, `delay` or `exchanged`
    double gain = 1;                        ///< measured = gain · true; negative if the sign is wrong
    double delay = 0;                       ///< s, positive if late
    double standard_error = 0;              ///< of gain or delay (s)
    std::string exchanged_with;             ///< channel, for `exchanged`
    double explained = 0;                   ///< part of the excess over noise that its correction takes away
    std::vector<std::string> alternatives;  ///< channels whose fault would explain nearly as much
};

/// @param fitted rigid part of the signals J x, channels x samples; @param residuals measured minus rigid
/// @param noise RMS of one channel; @param interval s
std::vector<ChannelSuspect> findSuspects(const std::vector<MarkerChannel>& channels, const Eigen::MatrixXd& fitted,
                                         const Eigen::MatrixXd& residuals, double noise, double interval);

}  // namespace wems::identify
