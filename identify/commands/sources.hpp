/// @file
/// What a command works on: files, or what is in memory already.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "models/mount_model.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"
#include "models/result/result_record.hpp"

namespace wems::identify::commands {

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

}  // namespace wems::identify::commands
