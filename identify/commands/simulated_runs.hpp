/// @file
/// Free simulations before and after in the report of a diagnosis: envelope and error over swept frequency, orders.
#pragma once

#include <vector>

#include "identify/commands/judged_runs.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

/// @param noise_floor what the noise alone leaves, relative to the measured motion
/// @param named axis whose envelope and orders are drawn; absent: the one that moves most
void addSimulatedRuns(HtmlReport& page, const std::vector<JudgedRun>& runs, const MountModel& before,
                      const MountModel& after, double noise_floor, const std::optional<AxisPlace>& named);

}  // namespace wems::identify::commands
