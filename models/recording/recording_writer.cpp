#include "models/recording/recording_writer.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "models/error.hpp"
#include "models/recording/csv_writer.hpp"
#include "models/recording/opensim_writer.hpp"

namespace wems {

std::unique_ptr<RecordingWriter> openRecordingWriter(const Recording& header, const RowPlan& plan,
                                                     const std::string& file, const WriteOptions& options) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".trc") return std::make_unique<TrcWriter>(header, plan, file, options);
    if (extension == ".sto" || extension == ".mot")
        return std::make_unique<StorageWriter>(header, plan, file, options.digits);
    for (const char* read_only : {".mat", ".uff", ".unv", ".h5", ".xlsx", ".tdms"}) {
        if (extension == read_only)
            throw InputError({file, 0, {}}, extension + " is not written", ".csv, .trc, .sto, .mot");
    }
    return std::make_unique<CsvWriter>(header, file, options.digits);
}

std::vector<std::string> writeRecording(const Recording& recording, const std::string& file,
                                        const WriteOptions& options, OutputFiles& outputs) {
    const auto writer =
        openRecordingWriter(recording, {recording.sampleCount(), recording.sampleInterval()}, file, options);
    writer->append(recording);
    outputs.add(writer->finish());
    return writer->notes();
}

std::vector<std::string> writeRecording(const Recording& recording, const std::string& file,
                                        const WriteOptions& options) {
    OutputFiles outputs;
    auto notes = writeRecording(recording, file, options, outputs);
    outputs.commit();
    return notes;
}

}  // namespace wems
