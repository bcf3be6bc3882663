/// @file
/// Where a residual sits that no cause explains.
#pragma once

#include <string>
#include <vector>

#include "identify/exact/open_loop_problem.hpp"

namespace wems::identify {

/// Share of a residual of the mount's equation that a force of any history at one axis could make.
struct PlaceShare {
    std::size_t connection = 0, axis = 0;
    std::string name;  ///< `1.x`
    double share = 0;  ///< 0 … 1 of what exceeds the noise
};

/// All axes, by falling share. No law enters: at each frequency the residual's six values are projected on the
/// direction of the axis.
std::vector<PlaceShare> calcPlaceShares(const OpenLoopProblem& problem, const MountModel& model,
                                        const WhiteVector& residual);

/// What the mount's equation leaves above the noise, per value.
double calcMountExcess(const OpenLoopProblem& problem, const WhiteVector& residual);
/// The same of the bracket's equation; 0 where there is none.
double calcBracketExcess(const OpenLoopProblem& problem, const WhiteVector& residual);

/// Mean square of the values of both equations in bands of 1 Hz, from 0 Hz on; NaN where there are none.
std::vector<double> calcMisfitByFrequency(const OpenLoopProblem& problem, const WhiteVector& residual);

/// `free`, `contact` or both: where the mount's residual of a model sits.
std::vector<std::string> findRegimes(const OpenLoopProblem& problem, const MountModel& model);

/// A force of any history at one axis of one connection has a known direction in the six equations: the share of the
/// residual that lies along it tells the place without knowing the law. Returns the axes (`1.x`) that carry the
/// residual, or `bracket`, followed by the regime it belongs to, `free`, `contact`, or both.
std::vector<std::string> locateResidual(const OpenLoopProblem& problem, const MountModel& model,
                                        const WhiteVector& residual);

}  // namespace wems::identify
