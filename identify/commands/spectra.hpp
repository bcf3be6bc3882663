/// @file
/// Frequency responses, densities, orders, shock response and margins of recordings.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/format.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/spectra/run_spectra.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

// What `identify spectra` found, as tables, JSON and pages.

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

struct SpectraRequest {
    std::vector<RecordingSource> recordings;
    ModelSource model;              ///< may be empty
    std::string columns, geometry;  ///< files; may be empty
    SpectraSettings settings;
};

struct SpectraAnswer {
    std::vector<RunSpectra> runs;
    std::vector<std::string> warnings;  ///< about the recordings
    ResultRecord record;
};

/// @throws InputError
SpectraAnswer runSpectra(const SpectraRequest& request, Watcher& watcher);

nlohmann::json toJson(const SpectraAnswer& answer);
std::string formatText(const SpectraAnswer& answer, TextStyle style);
void writeReport(const SpectraAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
