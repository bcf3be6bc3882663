#include "identify/cli/recordings.hpp"

#include <algorithm>

#include "models/error.hpp"
#include "models/recording/connection_checks.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {

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

MountModel readDeviceModel(const std::string& file, const std::string& geometry) {
    MountModel model = readMountModel(file);
    if (geometry.empty()) return model;
    for (SensorPlace& place : readSensorPlaces(geometry)) model.places.push_back(std::move(place));
    try {
        validate(model);
    } catch (const InputError& error) {
        throw InputError({geometry, 0, error.location().key}, error.problem(), error.accepted());
    }
    return model;
}

void checkConnections(Recording& recording, const MountModel& model) {
    for (const Finding& finding : checkAgainstModel(recording, model)) recording.warnings.push_back(finding.message);
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

std::vector<Recording> readDeviceRecordings(const std::vector<std::string>& files, const std::string& column_map,
                                            const MountModel& model) {
    const std::optional<ColumnMap> map = readDeviceMap(column_map, model);
    std::vector<Recording> recordings;
    recordings.reserve(files.size());
    for (const auto& file : files) {
        recordings.push_back(readRecording(file, map ? &*map : nullptr));
        checkConnections(recordings.back(), model);
    }
    return recordings;
}

}  // namespace wems::identify::cli
