/// @file
/// Reading recordings for a command: the column map, and the checks that need the model.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/commands/sources.hpp"
#include "identify/commands/watcher.hpp"
#include "models/mount_model.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::commands {

/// The column map of `--columns`; nothing if `file` is empty.
std::optional<ColumnMap> readOptionalMap(const std::string& file);

/// The same with the columns that the model's sensor tables name.
std::optional<ColumnMap> readDeviceMap(const std::string& file, const MountModel& model);

/// The model of `--model`, and the sensors of `--geometry` unless `geometry` is empty.
MountModel readDeviceModel(const ModelSource& source, const std::string& geometry);

/// What a command on recordings reads before them.
struct DeviceInputs {
    std::optional<MountModel> model;  ///< nothing where none was named
    std::optional<ColumnMap> map;     ///< with the columns that the model's sensor tables name

    const MountModel* findModel() const { return model ? &*model : nullptr; }
    const ColumnMap* findMap() const { return map ? &*map : nullptr; }
};

/// Enters the files of a command into its record, tells the watcher of all of them, and reads model and map.
/// @param recordings each with its role
DeviceInputs readInputs(const ModelSource& model, const std::string& columns, const std::string& geometry,
                        const std::vector<std::pair<std::string, RecordingSource>>& recordings, ResultRecord& record,
                        Watcher& watcher);
/// The same for recordings that all have the role `recording`.
DeviceInputs readInputs(const ModelSource& model, const std::string& columns, const std::string& geometry,
                        const std::vector<RecordingSource>& recordings, ResultRecord& record, Watcher& watcher);

/// Connections that are missing, unknown or exchanged join the recording's warnings.
void checkConnections(Recording& recording, const MountModel& model);
/// The same of a whole recording, with accelerations that contradict the displacements beside them.
void checkWhole(Recording& recording, const MountModel& model);

/// @param file of the model
/// @throws InputError if no elastomer has a stiffness that a fit could start from
void checkFitStart(const MountModel& model, const std::string& file);

/// @throws InputError if a recording's rate is below twice the lowest natural frequency, as with a wrong unit of time
void checkSampleRate(const std::vector<Recording>& recordings, const MountModel& model);

/// @throws InputError if displacements are none of rigid parts of the model's size: no rotation could be told from them
void checkDisplacements(const std::vector<Recording>& recordings, const MountModel& model);

/// Leaves out what `use` does not name of the channels of both parts: `all`, `displacements` or `accelerations` alone.
void keepOnly(const std::string& use, Recording& recording);

/// Reads recordings of a device and checks their connections against the model's.
/// @throws InputError as readRecording()
std::vector<Recording> readDeviceRecordings(const std::vector<RecordingSource>& sources, const std::string& column_map,
                                            const MountModel& model);

}  // namespace wems::identify::commands
