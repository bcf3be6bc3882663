/// @file
/// Commands on a test of several runs (`--test campaign.toml`).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/commands/sources.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "models/test_campaign.hpp"

namespace wems::identify::commands {

/// What a command needs to know of its runs, from the caller or from a test file.
struct RunSelection {
    std::vector<RecordingSource> recordings, validation;
    ModelSource model;
    std::string test;      ///< file that lists the runs; empty without
    std::string columns;   ///< column map; empty without
    std::string geometry;  ///< sensors that are not at the connections; empty without
};

/// Fills in what the test file says; what the caller says goes before it.
/// @throws InputError: recordings both ways or neither, no model
std::optional<TestCampaign> resolveRuns(RunSelection& selection);

/// All files that the runs, the model and the options name.
void addInputs(ResultRecord& record, const RunSelection& selection, const MountModel& model);

/// Error of a model on one validation run: of its free simulation, relative to the measured relative displacement.
struct ValidationError {
    std::string file;
    double error = 0;     ///< infinite without a simulation …
    std::string problem;  ///< … and why there is none
};
std::vector<ValidationError> validateModel(const MountModel& model, const std::vector<Recording>& recordings);

}  // namespace wems::identify::commands
