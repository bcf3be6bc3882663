/// @file
/// What is in recordings, what is suspicious, what can be identified from them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "identify/commands/long_recordings.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/inspect/inspection.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

struct InspectRequest {
    std::vector<RecordingSource> recordings;
    ModelSource model;              ///< may be empty
    std::string columns, geometry;  ///< files; may be empty
    MemoryOption memory;
};

struct InspectedRecording {
    Inspection inspection;
    Recording recording;  ///< without values
};

struct InspectAnswer {
    std::vector<InspectedRecording> recordings;
    ResultRecord record;

    /// Whether anything is suspicious.
    bool hasFindings() const;
};

/// @throws InputError
InspectAnswer runInspect(const InspectRequest& request, Watcher& watcher);

nlohmann::json toJson(const InspectAnswer& answer);
std::string formatText(const InspectAnswer& answer, TextStyle style);
void writeReport(const InspectAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
