#include "identify/cli/campaign.hpp"

#include <cmath>
#include <limits>

#include "identify/forward/simulation_diverged.hpp"
#include "identify/forward/simulation_error.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/error.hpp"

namespace wems::identify::cli {

std::optional<TestCampaign> resolveRuns(RunSelection& selection, CommonOptions& common) {
    std::optional<TestCampaign> campaign;
    if (!selection.test.empty()) {
        if (!selection.recordings.empty() || !selection.validation.empty())
            throw InputError({"", 0, "--test"}, "and recordings on the command line are both given", "one of them");
        campaign = readTestCampaign(selection.test);
        selection.recordings = campaign->listFiles(false);
        selection.validation = campaign->listFiles(true);
        if (selection.model.empty()) selection.model = campaign->model;
        if (common.column_map.empty()) common.column_map = campaign->columns;
        if (common.geometry.empty()) common.geometry = campaign->geometry;
    }
    if (selection.recordings.empty())
        throw InputError({"", 0, "recordings"}, "none is given", "files, or --test campaign.toml");
    if (selection.model.empty()) throw InputError({"", 0, "--model"}, "is required", "a mount model (TOML)");
    return campaign;
}

std::vector<std::string> listInputs(const RunSelection& selection, const CommonOptions& common,
                                    const MountModel& model) {
    std::vector<std::string> files{selection.model, selection.test, common.column_map, common.geometry,
                                   model.bracket_path};
    files.insert(files.end(), selection.recordings.begin(), selection.recordings.end());
    files.insert(files.end(), selection.validation.begin(), selection.validation.end());
    return files;
}

std::vector<ValidationError> validateModel(const MountModel& model, const std::vector<Recording>& recordings) {
    std::vector<ValidationError> errors;
    for (const Recording& recording : recordings) {
        const RunMotion run = estimateMotion(recording, model);
        try {
            const PreparedRun prepared = prepareRun(run, model, findSweptFrequency(recording).lowest);
            errors.push_back({recording.file, calcSimulationError(model, prepared).value(), {}});
        } catch (const SimulationDiverged& why) {
            errors.push_back({recording.file, std::numeric_limits<double>::infinity(), why.what()});
        }
    }
    return errors;
}

}  // namespace wems::identify::cli
