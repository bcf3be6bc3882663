/// @file
/// Two recordings over each other: in time, as envelope and orders over the swept frequency, and as spectra.
#pragma once

#include "identify/forward/compare.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

/// The channels that move most and those that hold most of the error, measured and simulated.
void addComparedMotions(HtmlReport& page, const Comparison& comparison);

}  // namespace wems::identify::commands
