#include "models/recording/recording_reader.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "models/recording/csv_reader.hpp"
#include "models/recording/json_reader.hpp"
#include "models/recording/lvm_reader.hpp"
#include "models/recording/mat_file.hpp"
#include "models/recording/mat_reader.hpp"
#include "models/recording/opensim_reader.hpp"
#include "models/recording/recording_table.hpp"
#include "models/recording/uff_reader.hpp"

namespace wems {

namespace {

template <typename Rows>
std::unique_ptr<RowSource> openAs(const std::string& file, const ColumnMap* map) {
    return std::make_unique<Rows>(file, map);
}

}  // namespace

const std::vector<TextFormat>& textFormats() {
    static const std::vector<TextFormat> formats{
        {isTrc, readTrc, openAs<OpensimRows>, {".trc"}, "a line that begins with PathFileType"},
        {isLvm, readLvm, openAs<LvmRows>, {".lvm"}, "a line that begins with LabVIEW Measurement"},
        {isUniversalFile,
         readUniversalFile,
         openAs<UffRows>,
         {".uff", ".unv"},
         "a line -1, then a line with a dataset's number"},
        // Last: it looks for the end of a header anywhere in the first lines.
        {isStorage, readStorage, openAs<OpensimRows>, {".sto", ".mot"}, "a header that ends with the line endheader"}};
    return formats;
}

const TextFormat* findTextFormat(std::string_view text) {
    for (const TextFormat& format : textFormats())
        if (format.recognises(text)) return &format;
    return nullptr;
}

namespace {

constexpr const char* kModelExtension = ".toml";  // of what is given in place of a recording by mistake

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
    if (extension == ".h5" || extension == ".hdf5") return "an HDF5 file";
    if (extension == ".json") return "an object of arrays, or rows of numbers";
    for (const TextFormat& format : textFormats())
        if (std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end())
            return format.beginning;
    return nullptr;
}

enum class Format { hdf5, mat, json, text, csv };

/// From the beginning of a file, without byte-order mark.
Format findFormat(std::string_view text, const std::string& extension) {
    if (isHdf5(text)) return Format::hdf5;
    if (text.substr(0, 10) == "MATLAB 5.0" || extension == ".mat") return Format::mat;
    if (isJson(text)) return Format::json;
    return findTextFormat(text) != nullptr ? Format::text : Format::csv;
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
        case Format::json:
            return makeRecording(readJson(text, file), map);
        case Format::text:
            return makeRecording(findTextFormat(text)->read(text, file), map);
        case Format::csv:
            break;
    }
    if (extension == kModelExtension)
        throw InputError({file, 0, {}}, "a TOML file where a recording is expected", kReadableFormats);
    if (const char* beginning = findPromise(extension))
        throw InputError({file, 0, {}}, "the content is not what the name " + extension + " promises", beginning);
    return parseRecording(text, file, map);
}

namespace {

/// The beginning of a file on disk; empty where there is none.
std::string readHead(const std::string& file) {
    std::error_code status;
    if (!std::filesystem::is_regular_file(file, status)) return {};
    std::ifstream input(file, std::ios::binary);
    std::string head(65536, '\0');
    input.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(std::max<std::streamsize>(0, input.gcount()));
    return head;
}

}  // namespace

bool isStreamable(const std::string& file) {
    const std::string head = readHead(file);
    const std::string_view text = skipByteOrderMark(head);
    if (text.empty()) return false;
    const std::string extension = findExtension(file);
    switch (findFormat(text, extension)) {
        case Format::text:
        case Format::hdf5:
            return true;
        case Format::mat:
        case Format::json:
            return false;
        case Format::csv:
            break;
    }
    const bool utf16 = text.substr(0, 2) == "\xFF\xFE" || text.substr(0, 2) == "\xFE\xFF";
    return !utf16 && extension != kModelExtension && findPromise(extension) == nullptr;
}

std::unique_ptr<RowSource> openRows(const std::string& file, const ColumnMap* map) {
    const std::string head = readHead(file);
    const std::string_view text = skipByteOrderMark(head);
    switch (findFormat(text, findExtension(file))) {
        case Format::text:
            return findTextFormat(text)->open(file, map);
        case Format::hdf5:
            return std::make_unique<Hdf5Rows>(file, map);
        case Format::mat:
            throw InputError({file, 0, {}}, "a MATLAB file of version 4 or 5 is not read in blocks",
                             "MATLAB 7.3, HDF5, CSV, UFF 58, OpenSim, LabVIEW .lvm");
        case Format::json:
            throw InputError({file, 0, {}}, "JSON is not read in blocks",
                             "MATLAB 7.3, HDF5, CSV, UFF 58, OpenSim, LabVIEW .lvm");
        case Format::csv:
            break;
    }
    return std::make_unique<CsvRows>(file, map);
}

}  // namespace wems
