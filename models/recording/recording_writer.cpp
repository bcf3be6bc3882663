#include "models/recording/recording_writer.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "models/error.hpp"
#include "models/recording/csv_writer.hpp"
#include "models/recording/opensim_writer.hpp"

namespace wems {

std::vector<std::string> writeRecording(const Recording& recording, const std::string& file,
                                        const WriteOptions& options) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".trc") return writeTrc(recording, file, options);
    if (extension == ".sto" || extension == ".mot") {
        writeStorage(recording, file, options);
        return {};
    }
    for (const char* read_only : {".mat", ".uff", ".unv", ".h5", ".xlsx", ".tdms"}) {
        if (extension == read_only)
            throw InputError({file, 0, {}}, extension + " is not written", ".csv, .trc, .sto, .mot");
    }
    writeCsv(recording, file, options.digits);
    return {};
}

}  // namespace wems
