/// @file
/// Stiffness, clearance, stop stiffness and damping of a mount's connections, or of one element on a test machine, with
/// intervals.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "identify/commands/fit_output.hpp"
#include "identify/commands/long_recordings.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/component/component_fit.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

struct FitRequest {
    RunSelection runs;
    FitOptions fit;
    MemoryOption memory;
    /// What a device is fitted to: `motion` (its equations of motion), `simulation` (fit/output_error.hpp), or `auto`:
    /// motion wherever the sampling holds its derivatives.
    std::string method = "auto";
    std::string use = "all";     ///< channels of both parts: `all`, `displacements`, `accelerations`
    ComponentOptions component;  ///< of one element; with an axis or a mass, the recordings are taken as its test
    /// Shape of an element's law: `model`, or `found`: what its tests show (component/component_diagnosis.hpp).
    std::string law = "model";
    bool timing = false;       ///< whether the steps' times are part of the answer
    bool wants_model = false;  ///< whether the notes say how the fitted model was kept within what a model may hold
    bool keeps_runs = false;   ///< whether the answer holds what a report draws
};

struct FitAnswer {
    MountModel start, fitted;        ///< before, and after within what a model may hold
    std::optional<FitResult> mount;  ///< or …
    std::optional<ComponentFit> element;
    std::vector<std::string> notes;
    Timing timing;
    std::optional<BlockUse> blocks;
    std::vector<ValidationError> validation;
    std::vector<std::string> validation_names;  ///< as the test file describes them
    std::vector<RunMotion> runs;                ///< for the report, as are:
    std::vector<Recording> recordings;
    ComponentOptions component;
    ResultRecord record;

    /// `identified`, `doubtful`, `unexplained`
    std::string verdict() const;
};

/// @throws InputError
FitAnswer runFit(FitRequest request, Watcher& watcher);

nlohmann::json toJson(const FitAnswer& answer);
std::string formatText(const FitAnswer& answer, TextStyle style);
/// Of an answer that keeps its runs.
void writeReport(const FitAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
