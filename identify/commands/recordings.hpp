/// @file
/// Reading recordings for a command: the column map, and the checks that need the model.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/common/progress.hpp"
#include "models/mount_model.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"
#include "models/result/result_record.hpp"
#include "models/test_campaign.hpp"

namespace wems::identify::commands {

// Who follows a command at work: a terminal, a notebook.

/// Told by the thread that called the command. What it throws ends the command.
class Watcher {
public:
    Watcher() = default;
    virtual ~Watcher() = default;
    Watcher(const Watcher&) = delete;
    Watcher& operator=(const Watcher&) = delete;

    /// All files that the command reads, before anything is computed.
    virtual void onInputs(const std::vector<std::string>& /*files*/) {}
    /// A step begins.
    virtual void onStep(const ProgressEvent& /*step*/) {}
    /// A step that can tell how far it is. @param done 0 to 1
    virtual void onProgress(double /*done*/, const std::string& /*what*/) {}
};

// What a command works on: files, or what is in memory already.

struct RecordingSource {
    RecordingSource() = default;
    RecordingSource(std::string name) : file(std::move(name)) {}  // NOLINT(google-explicit-constructor): a file is one
    RecordingSource(std::string name, std::shared_ptr<const Recording> recording)
        : file(std::move(name)), loaded(std::move(recording)) {}

    std::string file;  ///< of a recording in memory: what messages call it
    std::shared_ptr<const Recording> loaded;
};

struct ModelSource {
    ModelSource() = default;
    ModelSource(std::string name) : file(std::move(name)) {}  // NOLINT(google-explicit-constructor): a file is one
    ModelSource(std::string name, std::shared_ptr<const MountModel> model)
        : file(std::move(name)), loaded(std::move(model)) {}

    std::string file;
    std::shared_ptr<const MountModel> loaded;
    bool empty() const { return file.empty() && !loaded; }
};

/// A copy of what is in memory, or the file read with the map. @throws InputError
Recording readSource(const RecordingSource& source, const ColumnMap* map);
MountModel readSource(const ModelSource& source);

/// Names of the files among them.
void addInput(ResultRecord& record, const std::string& role, const RecordingSource& source);
void addInput(ResultRecord& record, const std::string& role, const ModelSource& source);

/// The files of a record, for Watcher::onInputs().
std::vector<std::string> listFiles(const ResultRecord& record);

/// `wems identify 0.1.0`, the command, no inputs yet.
ResultRecord beginRecord(const std::string& command);

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

// Commands on a test of several runs (`--test campaign.toml`).

/// What a command needs to know of its runs, from the caller or from a test file.
struct RunSelection {
    std::vector<RecordingSource> recordings, validation;
    ModelSource model;
    std::string test;      ///< file that lists the runs; empty without
    std::string columns;   ///< column map; empty without
    std::string geometry;  ///< sensors that are not at the connections; empty without
};

/// Fills in what the test file says; what the caller says goes before it.
/// @throws InputError: recordings both ways or neither, no model
std::optional<TestCampaign> resolveRuns(RunSelection& selection);

/// All files that the runs, the model and the options name.
void addInputs(ResultRecord& record, const RunSelection& selection, const MountModel& model);

/// Error of a model on one validation run: of its free simulation, relative to the measured relative displacement.
struct ValidationError {
    std::string file;
    double error = 0;     ///< infinite without a simulation …
    std::string problem;  ///< … and why there is none
};
std::vector<ValidationError> validateModel(const MountModel& model, const std::vector<Recording>& recordings);

}  // namespace wems::identify::commands
