/// @file
/// What `identify spectra` found, as tables, JSON and pages.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/format.hpp"
#include "identify/spectra/run_spectra.hpp"

namespace wems::identify::commands {

/// RMS and peak of every channel that is not constant.
Table tabulateLevels(const RunSpectra& run);
/// Resonances: `transmissibility mobile.4.az/fixed.4.az`, amplification, frequency, damping, coherence.
Table tabulatePeaks(const std::vector<ChannelTransfer>& transfers);
/// Stroke, force, clearance left of every connection that moves.
Table tabulateMargins(const Margins& margins);

std::string formatSpectra(const std::vector<RunSpectra>& runs, TextStyle style);
nlohmann::json makeSpectraJson(const std::vector<RunSpectra>& runs);
/// All runs overlaid. @throws InputError: cannot be written
void writeSpectraReport(const std::vector<RunSpectra>& runs, const std::string& file, OutputFiles& outputs);

/// Unit in which a quantity is shown, and its factor from SI: g for accelerations, mm for displacements.
struct SpectrumUnit {
    const char* name;
    double factor;
};
SpectrumUnit findSpectrumUnit(Quantity quantity);

}  // namespace wems::identify::commands
