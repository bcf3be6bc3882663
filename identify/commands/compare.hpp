/// @file
/// Errors of a simulated recording, channel by channel, by frequency band and by regime.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/recordings.hpp"
#include "identify/forward/compare.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

// Two recordings over each other: in time, as envelope and orders over the swept frequency, and as spectra.

/// The channels that move most and those that hold most of the error, measured and simulated.
void addComparedMotions(HtmlReport& page, const Comparison& comparison);

struct CompareRequest {
    RecordingSource measured, simulated;
    ModelSource model;              ///< may be empty
    std::string columns, geometry;  ///< files; may be empty
};

struct CompareAnswer {
    Comparison comparison;
    std::string measured, simulated;    ///< what they are called
    std::vector<std::string> warnings;  ///< about the recordings
    ResultRecord record;
};

/// @throws InputError
CompareAnswer runCompare(const CompareRequest& request, Watcher& watcher);

nlohmann::json toJson(const CompareAnswer& answer);
std::string formatText(const CompareAnswer& answer, TextStyle style);
void writeReport(const CompareAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
