#include "identify/commands/campaign.hpp"

#include <cmath>
#include <limits>

#include "identify/forward/simulation_diverged.hpp"
#include "identify/forward/simulation_error.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/error.hpp"

namespace wems::identify::commands {

std::optional<TestCampaign> resolveRuns(RunSelection& selection) {
    std::optional<TestCampaign> campaign;
    if (!selection.test.empty()) {
        if (!selection.recordings.empty() || !selection.validation.empty())
            throw InputError({"", 0, "--test"}, "and recordings on the command line are both given", "one of them");
        campaign = readTestCampaign(selection.test);
        for (const std::string& file : campaign->listFiles(false)) selection.recordings.emplace_back(file);
        for (const std::string& file : campaign->listFiles(true)) selection.validation.emplace_back(file);
        if (selection.model.empty()) selection.model = ModelSource(campaign->model);
        if (selection.columns.empty()) selection.columns = campaign->columns;
        if (selection.geometry.empty()) selection.geometry = campaign->geometry;
    }
    if (selection.recordings.empty())
        throw InputError({"", 0, "recordings"}, "none is given", "files, or --test campaign.toml");
    if (selection.model.empty()) throw InputError({"", 0, "--model"}, "is required", "a mount model (TOML)");
    return campaign;
}

void addInputs(ResultRecord& record, const RunSelection& selection, const MountModel& model) {
    addInput(record, "model", selection.model);
    record.addInput("bracket modes", model.bracket_path);
    record.addInput("test", selection.test);
    record.addInput("columns", selection.columns);
    record.addInput("geometry", selection.geometry);
    for (const RecordingSource& source : selection.recordings) addInput(record, "recording", source);
    for (const RecordingSource& source : selection.validation) addInput(record, "validation", source);
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

}  // namespace wems::identify::commands
