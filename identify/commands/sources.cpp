#include "identify/commands/sources.hpp"

#include "models/recording/recording_reader.hpp"

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

}  // namespace wems::identify::commands
