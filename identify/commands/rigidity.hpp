/// @file
/// Does each part of a recording move as a rigid body?
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "identify/commands/recordings.hpp"
#include "identify/inspect/quality.hpp"
#include "identify/motion/rigidity.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

struct RigidityRequest {
    RecordingSource recording;
    ModelSource model;
    std::string columns, geometry;  ///< files; may be empty
};

struct RigidityAnswer {
    Rigidity rigidity;
    QualityVerdict quality;
    Recording recording;
    MountModel model;
    ResultRecord record;

    /// The largest value of any check, percent.
    double findLargest() const;
};

/// @throws InputError
RigidityAnswer runRigidity(const RigidityRequest& request, Watcher& watcher);

nlohmann::json toJson(const RigidityAnswer& answer);
std::string formatText(const RigidityAnswer& answer, TextStyle style);
void writeReport(const RigidityAnswer& answer, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
