#include "identify/cli/recordings.hpp"

#include "models/recording/connection_checks.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {

std::optional<ColumnMap> readOptionalMap(const std::string& file) {
    if (file.empty()) return std::nullopt;
    return readColumnMap(file);
}

void checkConnections(Recording& recording, const MountModel& model) {
    for (const Finding& finding : checkAgainstModel(recording, model)) recording.warnings.push_back(finding.message);
}

std::vector<Recording> readDeviceRecordings(const std::vector<std::string>& files, const std::string& column_map,
                                            const MountModel& model) {
    const std::optional<ColumnMap> map = readOptionalMap(column_map);
    std::vector<Recording> recordings;
    recordings.reserve(files.size());
    for (const auto& file : files) {
        recordings.push_back(readRecording(file, map ? &*map : nullptr));
        checkConnections(recordings.back(), model);
    }
    return recordings;
}

}  // namespace wems::identify::cli
