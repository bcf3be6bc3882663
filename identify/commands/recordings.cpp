#include "identify/commands/recordings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/forward/compare.hpp"
#include "identify/forward/step_size.hpp"
#include "identify/inspect/connection_checks.hpp"
#include "identify/inspect/quality.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/linear_modes.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/sensor_reading.hpp"

namespace wems::identify::commands {

Recording readSource(const RecordingSource& source, const ColumnMap* map) {
    if (!source.loaded) return readRecording(source.file, map);
    Recording recording = *source.loaded;
    recording.file = source.file;
    return recording;
}

MountModel readSource(const ModelSource& source) {
    return source.loaded ? *source.loaded : readMountModel(source.file);
}

void addInput(ResultRecord& record, const std::string& role, const RecordingSource& source) {
    record.addInput(role, source.file, source.loaded != nullptr);
}

void addInput(ResultRecord& record, const std::string& role, const ModelSource& source) {
    record.addInput(role, source.file, source.loaded != nullptr);
}

std::vector<std::string> listFiles(const ResultRecord& record) {
    std::vector<std::string> files;
    for (const InputRecord& input : record.inputs)
        if (!input.in_memory) files.push_back(input.file);
    return files;
}

ResultRecord beginRecord(const std::string& command) {
    ResultRecord record;
    record.program = "wems identify " WEMS_VERSION;
    record.command = command;
    return record;
}

namespace {

constexpr std::size_t least_samples = 8;  // that a motion is estimated from

/// Hz; 0 where the model alone has no stable rest.
double findLowestFrequency(const MountModel& model) {
    constexpr double reference = 10;  // Hz; the order of magnitude counts
    try {
        return findLinearModes(linearize(model, reference)).frequency.minCoeff();
    } catch (const InputError&) {
        return 0;
    }
}

}  // namespace

void checkFitStart(const MountModel& model, const std::string& file) {
    for (const Connection& connection : model.connections)
        for (const AxisLaw& law : connection.axis)
            if (law.stiffness > 0) return;
    throw InputError({file, 0, "connection"}, "every stiffness is 0",
                     "first guesses above 0, such as the design's: the fit starts from them");
}

void checkSampleRate(const std::vector<Recording>& recordings, const MountModel& model) {
    const double lowest = findLowestFrequency(model);
    if (!(lowest > 0)) return;
    for (const Recording& recording : recordings) {
        const double interval = recording.sampleInterval();
        if (!(interval > 0) || 1 / interval > 2 * lowest) continue;
        throw InputError({recording.file, 0, "time"},
                         "the sample rate of " + formatNumber(1 / interval, 3) +
                             " Hz is below twice the lowest natural frequency of the model, " +
                             formatNumber(lowest, 3) + " Hz",
                         "a higher rate; is the unit of time the right one?");
    }
}

void checkDisplacements(const std::vector<Recording>& recordings, const MountModel& model) {
    for (const Recording& recording : recordings) checkRigidBound(recording, model);
}

std::optional<ColumnMap> readOptionalMap(const std::string& file) {
    if (file.empty()) return std::nullopt;
    return readColumnMap(file);
}

std::optional<ColumnMap> readDeviceMap(const std::string& file, const MountModel& model) {
    std::optional<ColumnMap> map = readOptionalMap(file);
    const bool named = std::any_of(model.places.begin(), model.places.end(), [](const SensorPlace& place) {
        return std::any_of(place.columns.begin(), place.columns.end(), [](const auto& text) { return !text.empty(); });
    });
    if (!named) return map;
    if (!map) map = ColumnMap{};
    if (map->file.empty()) map->file = "geometry";
    addColumns(model.places, *map);
    return map;
}

MountModel readDeviceModel(const ModelSource& source, const std::string& geometry) {
    MountModel model = readSource(source);
    if (geometry.empty()) return model;
    for (SensorPlace& place : readSensorPlaces(geometry)) model.places.push_back(std::move(place));
    try {
        validate(model);
    } catch (const InputError& error) {
        throw InputError({geometry, 0, error.location().key}, error.problem(), error.accepted());
    }
    return model;
}

DeviceInputs readInputs(const ModelSource& model, const std::string& columns, const std::string& geometry,
                        const std::vector<std::pair<std::string, RecordingSource>>& recordings, ResultRecord& record,
                        Watcher& watcher) {
    DeviceInputs inputs;
    if (!model.empty()) inputs.model = readDeviceModel(model, geometry);
    addInput(record, "model", model);
    if (inputs.model) record.addInput("bracket modes", inputs.model->bracket_path);
    record.addInput("columns", columns);
    record.addInput("geometry", geometry);
    for (const auto& [role, source] : recordings) addInput(record, role, source);
    watcher.onInputs(listFiles(record));
    inputs.map = inputs.model ? readDeviceMap(columns, *inputs.model) : readOptionalMap(columns);
    if (inputs.map) record.addColumns(*inputs.map);
    return inputs;
}

DeviceInputs readInputs(const ModelSource& model, const std::string& columns, const std::string& geometry,
                        const std::vector<RecordingSource>& recordings, ResultRecord& record, Watcher& watcher) {
    std::vector<std::pair<std::string, RecordingSource>> named;
    for (const RecordingSource& source : recordings) named.emplace_back("recording", source);
    return readInputs(model, columns, geometry, named, record, watcher);
}

void checkConnections(Recording& recording, const MountModel& model) {
    for (const Finding& finding : checkAgainstModel(recording, model)) recording.warnings.push_back(finding.message);
}

void checkWhole(Recording& recording, const MountModel& model) {
    checkConnections(recording, model);
    for (std::string& sentence : findContradictions(recording)) recording.warnings.push_back(std::move(sentence));
}

void keepOnly(const std::string& use, Recording& recording) {
    if (use == "all") return;
    const Derivative kept = use == "accelerations" ? Derivative::acceleration : Derivative::displacement;
    auto& channels = recording.channels;
    channels.erase(std::remove_if(channels.begin(), channels.end(),
                                  [&](const Channel& channel) {
                                      const auto name = parseChannelName(channel.name);
                                      return name && (name->part == Part::mobile || name->part == Part::fixed) &&
                                             name->derivative != kept;
                                  }),
                   channels.end());
}

std::vector<Recording> readDeviceRecordings(const std::vector<RecordingSource>& sources, const std::string& column_map,
                                            const MountModel& model) {
    const std::optional<ColumnMap> map = readDeviceMap(column_map, model);
    std::vector<Recording> recordings;
    recordings.reserve(sources.size());
    for (const RecordingSource& source : sources) {
        recordings.push_back(readSource(source, map ? &*map : nullptr));
        if (recordings.back().sampleCount() < least_samples)
            throw InputError({source.file, 0, "time"},
                             "only " + std::to_string(recordings.back().sampleCount()) + " samples",
                             "at least " + std::to_string(least_samples));
        checkWhole(recordings.back(), model);
    }
    return recordings;
}

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
        const RunMotion run = estimateMotion(correctChannels(recording, model.sensors), model);
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
