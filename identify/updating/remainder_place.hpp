/// @file
/// Where a residual sits that no cause explains.
#pragma once

#include <string>
#include <vector>

#include "identify/updating/selection.hpp"

namespace wems::identify::updating {

/// A force of any history at one axis of one connection has a known direction in the six equations: the share of the
/// residual that lies along it tells the place without knowing the law. Returns the axes (`1.x`) that carry the mount's
/// residual at a view, or `bracket`, followed by the regime that it belongs to: `free`, `contact`, or both.
std::vector<std::string> locateRemainder(const TestView& view, const std::vector<double>& misfit,
                                         const MountModel& model);

}  // namespace wems::identify::updating
