#include "models/recording/recording_writer.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "models/common/error.hpp"
#include "models/recording/opensim_writer.hpp"

namespace wems {

void appendNumber(double value, int digits, std::string& text) {
    if (std::isnan(value)) return;
    if (std::isinf(value)) throw std::invalid_argument("writeRecording: a value is infinite");
    std::array<char, 32> number{};
    const auto result =
        std::to_chars(number.data(), number.data() + number.size(), value, std::chars_format::general, digits);
    text.append(number.data(), result.ptr);
}

ChannelName parseValidName(const Channel& channel) {
    const auto name = parseChannelName(channel.name);
    if (!name) throw std::invalid_argument("writeRecording: '" + channel.name + "' is no name of a channel");
    return *name;
}

void checkRows(const Recording& rows, std::size_t channel_count) {
    if (rows.channels.size() != channel_count)
        throw std::invalid_argument("writeRecording: the rows have not the channels of the header");
    for (const auto& channel : rows.channels)
        if (channel.values.size() != rows.time.size())
            throw std::invalid_argument("writeRecording: channel '" + channel.name + "' is not as long as time");
}

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

namespace {

std::string quoteField(const std::string& text) {
    if (text.find_first_of(",;\"\t") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string oneLine(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return text;
}

}  // namespace

CsvWriter::CsvWriter(const Recording& header, const std::string& file, int digits)
    : digits_(std::clamp(digits, 1, 17)) {
    std::string text;
    for (const auto& [key, value] : header.metadata) text += "# " + oneLine(key) + ": " + oneLine(value) + "\n";
    text += "time [s]";
    for (const auto& channel : header.channels) {
        const Quantity quantity = findQuantity(parseValidName(channel));
        const std::string unit = channel.unit.empty() ? siUnit(quantity) : channel.unit;
        unit_factors_.push_back(findUnitFactor(unit, quantity, {file, 0, channel.name}));
        text += "," + quoteField(channel.name + " [" + unit + "]");
    }
    file_ = std::make_unique<AtomicFile>(file);
    file_->write(text + "\n");
}

void CsvWriter::append(const Recording& rows) {
    checkRows(rows, unit_factors_.size());
    std::string text;
    for (std::size_t i = 0; i < rows.time.size(); ++i) {
        appendNumber(rows.time[i], std::max(digits_, kTimeDigits), text);
        for (std::size_t j = 0; j < unit_factors_.size(); ++j) {
            text += ',';
            appendNumber(rows.channels[j].values[i] / unit_factors_[j], digits_, text);
        }
        text += '\n';
        if (text.size() < kFlushSize) continue;
        file_->write(text);
        text.clear();
    }
    file_->write(text);
}

std::unique_ptr<AtomicFile> CsvWriter::finish() {
    file_->finish();
    return std::move(file_);
}

void writeCsv(const Recording& recording, const std::string& file, int digits) {
    CsvWriter writer(recording, file, digits);
    writer.append(recording);
    writer.finish()->commit();
}

}  // namespace wems
