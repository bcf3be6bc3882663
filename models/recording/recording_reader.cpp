#include "models/recording/recording_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "models/error.hpp"
#include "models/recording/csv_reader.hpp"
#include "models/recording/mat_reader.hpp"
#include "models/recording/opensim_reader.hpp"
#include "models/recording/recording_table.hpp"
#include "models/recording/text_file.hpp"
#include "models/recording/uff_reader.hpp"

namespace wems {
namespace {

std::string findExtension(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// The signature stands at the beginning, or after a block of 512 bytes for the program's own use.
bool isHdf5(std::string_view text) {
    constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
    return text.substr(0, 8) == kSignature || (text.size() > 520 && text.substr(512, 8) == kSignature);
}

/// A file whose name promises a format that its content is not.
void rejectMisnamed(const std::string& file, const std::string& extension) {
    struct Promise {
        const char* extension;
        const char* beginning;
    };
    constexpr std::array<Promise, 7> kPromises = {{{".trc", "a line that begins with PathFileType"},
                                                   {".sto", "a header that ends with the line endheader"},
                                                   {".mot", "a header that ends with the line endheader"},
                                                   {".uff", "a line -1, then a line with a dataset's number"},
                                                   {".unv", "a line -1, then a line with a dataset's number"},
                                                   {".h5", "an HDF5 file"},
                                                   {".hdf5", "an HDF5 file"}}};
    for (const auto& promise : kPromises) {
        if (extension == promise.extension)
            throw InputError({file, 0, {}}, "the content is not what the name " + extension + " promises",
                             promise.beginning);
    }
}

}  // namespace

Recording readRecording(const std::string& file, const ColumnMap* map) {
    const std::string extension = findExtension(file);
    const TextFile content(file);
    std::string_view text = content.view();
    if (isHdf5(text)) return makeRecording(readMat(file, true), map);
    if (text.substr(0, 10) == "MATLAB 5.0" || extension == ".mat") return makeRecording(readMat(file, false), map);
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    if (isTrc(text)) return makeRecording(readTrc(text, file), map);
    if (isUniversalFile(text)) return makeRecording(readUniversalFile(text, file), map);
    if (isStorage(text)) return makeRecording(readStorage(text, file), map);
    rejectMisnamed(file, extension);
    return parseRecording(text, file, map);
}

}  // namespace wems
