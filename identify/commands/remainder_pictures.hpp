/// @file
/// What the fitted equations of motion leave of a run, as a report shows it: over time, over frequency, and its
/// autocorrelation.
#pragma once

#include <string>

#include "identify/fit/remainder.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

void addRemainder(HtmlReport& page, const RunRemainder& run, const std::string& name);

}  // namespace wems::identify::commands
