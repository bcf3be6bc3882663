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

}  // namespace wems::identify
