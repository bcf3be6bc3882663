#include "models/recording/recording_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "models/error.hpp"
#include "models/recording/csv_reader.hpp"
#include "models/recording/mat_extent.hpp"
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

/// How a file begins whose name promises another format than CSV; nullptr if it does not.
const char* findPromise(const std::string& extension) {
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
    for (const auto& promise : kPromises)
        if (extension == promise.extension) return promise.beginning;
    return nullptr;
}

enum class Format { hdf5, mat, trc, uff, storage, csv };

/// From the beginning of a file, without byte-order mark.
Format findFormat(std::string_view text, const std::string& extension) {
    if (isHdf5(text)) return Format::hdf5;
    if (text.substr(0, 10) == "MATLAB 5.0" || extension == ".mat") return Format::mat;
    if (isTrc(text)) return Format::trc;
    if (isUniversalFile(text)) return Format::uff;
    return isStorage(text) ? Format::storage : Format::csv;
}

std::string_view skipByteOrderMark(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    return text;
}

}  // namespace

Recording readRecording(const std::string& file, const ColumnMap* map) {
    const std::string extension = findExtension(file);
    const TextFile content(file);
    const std::string_view text = skipByteOrderMark(content.view());
    switch (findFormat(text, extension)) {
        case Format::hdf5:
            return makeRecording(readMat(file, true), map);
        case Format::mat:
            checkMatExtent(text, file);
            return makeRecording(readMat(file, false), map);
        case Format::trc:
            return makeRecording(readTrc(text, file), map);
        case Format::uff:
            return makeRecording(readUniversalFile(text, file), map);
        case Format::storage:
            return makeRecording(readStorage(text, file), map);
        case Format::csv:
            break;
    }
    if (const char* beginning = findPromise(extension))
        throw InputError({file, 0, {}}, "the content is not what the name " + extension + " promises", beginning);
    return parseRecording(text, file, map);
}

bool isPlainCsv(const std::string& file) {
    std::error_code status;
    if (!std::filesystem::is_regular_file(file, status)) return false;
    std::ifstream input(file, std::ios::binary);
    std::string head(65536, '\0');
    input.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, input.gcount())));
    const std::string_view text = skipByteOrderMark(head);
    const bool utf16 = text.substr(0, 2) == "\xFF\xFE" || text.substr(0, 2) == "\xFE\xFF";
    const std::string extension = findExtension(file);
    return !text.empty() && !utf16 && findPromise(extension) == nullptr && findFormat(text, extension) == Format::csv;
}

}  // namespace wems
