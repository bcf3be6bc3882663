/// @file
/// Amplitude and phase of the first harmonics along a sweep.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "identify/motion/swept_frequency.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

constexpr int tracked_orders = 3;

struct OrderTrack {
    std::string channel;
    Eigen::MatrixXd amplitude;  ///< orders x points, SI; NaN where the window is too short
    Eigen::MatrixXd phase;      ///< orders x points, rad, order n against n times the drive's first order
};

struct OrderTracking {
    std::vector<double> time, hertz;  ///< of the points
    std::string reference;            ///< channel whose first order has phase 0: the drive's strongest
    std::vector<OrderTrack> tracks;
};

/// At points evenly spaced in log frequency (for a sweep) the least-squares fit of a mean and `tracked_orders`
/// harmonics of the swept phase 2π∫f dt over five periods around. Empty unless the drive is a sine.
/// Vold–Kalman filters and the like serve order tracking where orders cross; one sine at a time needs none.
OrderTracking trackOrders(const Recording& recording, const SweptFrequency& swept, int points = 120);

/// Orders of a recording that comes in blocks: in each of a hundred bands a decade what the block holds in which the
/// drive was strongest there, so that a sweep that comes again and again is shown once, at its highest level. Blocks
/// driven most in another channel than the first one are left out.
class OrderEnvelope {
public:
    void add(const OrderTracking& block);
    OrderTracking finish() const;

private:
    struct Point {
        double time = 0, hertz = 0;
        Eigen::MatrixXd amplitude, phase;  // orders x channels
        double level = 0;                  // of the reference
    };
    std::string reference_;
    std::vector<std::string> channels_;
    std::map<long, Point> points_;  // by band
};

// Where a channel stands still although its signal moves: saturated sensors and drop-outs.

/// Findings of kind saturated and drop_out in one channel.
///
/// - Saturated: two runs or more of six samples or more within 7 noise deviations σ of the channel's largest (smallest)
///   value, entered and left by steps above 8 σ a sample. A smooth peak of curvature c (a sample squared) stays n
///   samples in such a band, n² = 56 σ/c, and leaves it by c n/2 = 28 σ/n: below 4.7 σ for n of 6 or more. Or: at least
///   30 samples in that band, in five separate excursions, and eight times as many as in each of the three bands beside
///   it on average; a sine of constant amplitude has three times as many. That band is at least four steps wide of the
///   values as they are written; where four of it do not fit between the largest value and the median, as above a
///   single high peak, there is no limit to see. Exact plateaus are the business of checkChannels() (clipped).
/// - Drop-out: the channel repeats one value, not its largest or smallest, for five samples or more and jumps off or
///   onto it by more than four steps of its resolution and 6 σ, in the midst of motion. Where that is so in a tenth of
///   all samples the channel holds each value for a while, because it was sampled more slowly than the others.
///
/// @param noise σ of the channel, in its SI unit
/// @param row row of the file of the first sample
std::vector<Finding> findPlateaus(const Channel& channel, const std::vector<double>& time, double noise, long row);

}  // namespace wems::identify
