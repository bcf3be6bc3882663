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

#include "identify/motion/channel_set.hpp"

namespace wems::identify {

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
