// The next test, which run would tell what the recordings leave open.
#include "identify/commands/plan.hpp"

#include <utility>

#include "identify/commands/plan_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/component/component_data.hpp"
#include "identify/motion/parallel.hpp"
#include "models/admissible_model.hpp"
#include "models/error.hpp"

namespace wems::identify::commands {
namespace {

std::vector<Recording> readRuns(const PlanRequest& request, const MountModel& model, const ColumnMap* map) {
    const std::vector<RecordingSource>& sources = request.runs.recordings;
    const auto size = estimateSize(sources, map);
    if (size && !size->component && exceedsMemory(*size, model, request.plan.fit, request.memory))
        throw InputError({sources.front().file, 0, "time"}, "the recordings need more than the memory of --memory",
                         "more memory, or the part of the recordings that identify convert cuts out");
    std::vector<Recording> recordings = readDeviceRecordings(sources, request.runs.columns, model);
    for (const Recording& recording : recordings)
        if (isComponentTest(recording))
            throw InputError({recording.file, 0, ""}, "a component test, which has no direction to choose",
                             "recordings of a whole device");
    checkFitStart(model, request.runs.model.file);
    checkSampleRate(recordings, model);
    for (Recording& recording : recordings) keepOnly(request.use, recording);
    return recordings;
}

nlohmann::json describeOptions(const PlanRequest& request) {
    const AskedSetup& asked = request.plan.asked;
    nlohmann::json options = {{"proposals", request.plan.most_proposals},
                              {"free", request.plan.fit.free_body},
                              {"use", request.use},
                              {"memory_MB", request.memory.megabytes}};
    const auto add = [&](const char* key, const std::optional<double>& value) {
        if (value) options[key] = *value;
    };
    add("max_force", asked.force);
    add("max_acceleration", asked.acceleration);
    add("max_displacement", asked.displacement);
    add("max_stroke", asked.stroke);
    add("rate", asked.octaves_per_minute);
    if (asked.band) options["sweep"] = {asked.band->first, asked.band->second};
    return options;
}

}  // namespace

PlanAnswer runPlan(PlanRequest request, Watcher& watcher) {
    PlanAnswer answer;
    answer.record = beginRecord("plan");
    resolveRuns(request.runs);
    answer.start = readDeviceModel(request.runs.model, request.runs.geometry);
    answer.model_file = request.model_file.empty() ? request.runs.model.file : request.model_file;
    addInputs(answer.record, request.runs, answer.start);
    answer.record.options = describeOptions(request);
    watcher.onInputs(listFiles(answer.record));
    const std::optional<ColumnMap> map = readDeviceMap(request.runs.columns, answer.start);
    if (map) answer.record.addColumns(*map);
    watcher.onStep("reading", 0, 1);
    const std::vector<Recording> recordings = readRuns(request, answer.start, map ? &*map : nullptr);
    watcher.onStep("motion of both parts", 0, 1);
    std::vector<RunMotion> runs(recordings.size());
    runParallel(runs.size(), [&](std::size_t r) { runs[r] = estimateMotion(recordings[r], answer.start); });
    constexpr double before = 0.1;  // of the time, for what comes before the rehearsals
    request.plan.progress = [&](double done, const std::string& what) {
        watcher.onStep(what, before + (1 - before) * done, 1);
    };
    answer.plan = makePlan(runs, recordings, answer.start, request.plan);
    for (const Recording& recording : recordings)
        for (const auto& warning : recording.warnings) answer.plan.notes.push_back(recording.file + ": " + warning);
    answer.fitted = answer.plan.now.model;
    const auto limited = makeAdmissible(answer.start, answer.fitted);
    if (!request.model_file.empty()) answer.plan.notes.insert(answer.plan.notes.end(), limited.begin(), limited.end());
    return answer;
}

nlohmann::json toJson(const PlanAnswer& answer) {
    nlohmann::json result = makePlanJson(answer.plan, answer.model_file);
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const PlanAnswer& answer, TextStyle style) {
    return formatPlan(answer.plan, answer.model_file, style);
}

void writeReport(const PlanAnswer& answer, const std::string& file, OutputFiles& outputs) {
    writePlanReport(answer.plan, answer.model_file, file, outputs);
}

}  // namespace wems::identify::commands
