/// @file
/// Commands on a test of several runs (`--test campaign.toml`).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/cli/command.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "models/test_campaign.hpp"

namespace wems::identify::cli {

/// What a command needs to know of its runs, from the command line or from a test file.
struct RunSelection {
    std::vector<std::string> recordings, validation;
    std::string model;
    std::string test;  ///< --test FILE; empty without
};

/// Fills what the test file says into `selection` and `common`; the command line goes before it.
/// @throws InputError: recordings both ways or neither, no model
std::optional<TestCampaign> resolveRuns(RunSelection& selection, CommonOptions& common);

/// All files that the runs, the model and the common options name.
std::vector<std::string> listInputs(const RunSelection& selection, const CommonOptions& common,
                                    const MountModel& model);

/// Error of a model on one validation run: of its free simulation, relative to the measured relative displacement.
struct ValidationError {
    std::string file;
    double error = 0;     ///< infinite without a simulation …
    std::string problem;  ///< … and why there is none
};
std::vector<ValidationError> validateModel(const MountModel& model, const std::vector<Recording>& recordings);

}  // namespace wems::identify::cli
