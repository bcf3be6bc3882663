/// @file
/// Frequency responses, densities, orders, shock response and margins of recordings.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/sources.hpp"
#include "identify/commands/watcher.hpp"
#include "identify/spectra/run_spectra.hpp"
#include "models/atomic_file.hpp"
#include "models/terminal.hpp"

namespace wems::identify::commands {

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
