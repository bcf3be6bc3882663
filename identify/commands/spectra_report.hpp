/// @file
/// One response of several runs over each other, divided by what drives it: equal for a linear device, so that what is
/// not shows at a glance.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/spectra/run_spectra.hpp"
#include "models/common/text_table.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

struct LevelCurve {
    std::string file;
    double drive = 0;                     ///< RMS of the reference, SI
    std::vector<double> hertz, response;  ///< first order along a sweep, else |H1|
    double peak_hertz = 0, peak = 0;      ///< largest response
    double stroke = 0;                    ///< m, largest relative displacement of all connections
    std::optional<double> left;           ///< m, least clearance left of all stops; below zero: pressed by so much
};

struct LevelOverlay {
    std::string reference, channel, unit;
    Quantity drive = Quantity::acceleration;
    std::vector<LevelCurve> curves;  ///< ascending in drive
};

/// Of the mobile part's channel that moves most along the drive. None unless there are two runs or more with the same
/// reference that hold this channel.
std::optional<LevelOverlay> makeLevelOverlay(const std::vector<RunSpectra>& runs);

Table tabulateLevels(const LevelOverlay& overlay);
Plot plotLevels(const LevelOverlay& overlay);
/// One sentence: how far the resonance moves from the lowest to the highest level.
std::string describeLevels(const LevelOverlay& overlay);

}  // namespace wems::identify::commands
