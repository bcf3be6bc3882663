/// @file
/// The motion of one axis as samples: where it turns, how fast it is, and what force a law opposes to it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/axis_law.hpp"

namespace wems {

/// Sample at which a motion turns, and where it goes from there.
struct Reversal {
    Eigen::Index index = 0;
    int direction = 0;  ///< +1 or −1, of the motion after it
};

/// Turning points of q that are followed by a travel of more than `fraction` of q's whole range (noise and ripple turn
/// nothing). The first and last samples are none.
std::vector<Reversal> findReversals(const Eigen::VectorXd& q, double fraction);

/// Derivative of `values` at a uniform `interval` by a least-squares line (`order` 1) or the second derivative by
/// a parabola (2), over ±`half_width` samples, one-sided at the ends (Savitzky, Golay 1964). Zero phase inside.
Eigen::VectorXd derive(const Eigen::VectorXd& values, double interval, int half_width, int order);

/// Half width of a derivative's window, samples: a sixtieth of the typical period costs 0.1 % at that period.
int chooseHalfWidth(const Eigen::VectorXd& q);

/// Displacement (m) and velocity (m/s) of an axis at both ends of an interval (s).
struct AxisInterval {
    double q0, v0, q1, v1, length;
};
/// What motion drags along (models/axis_law.hpp), moved over one interval: over the cubic through both ends with their
/// velocities. Where the velocity changes its sign the motion turns on the way, once; otherwise what counts is the
/// travel. @param z all internal states of the law, m
void dragAlong(const AxisForce& force, const AxisInterval& interval, double* z);

/// Force (N, sign of q) of a law along a motion: times (s), displacements (m) and velocities (m/s) of the samples.
/// Internal states begin at rest: dashpots of branches at the first displacement, what is dragged without stretch.
/// Between samples branches follow a displacement that is linear in time, exactly; what is dragged moves as `dragAlong`
/// says. The law's drift counts from the first sample.
Eigen::VectorXd calcForceAlong(const AxisLaw& law, const Eigen::VectorXd& time, const Eigen::VectorXd& q,
                               const Eigen::VectorXd& v);

}  // namespace wems
