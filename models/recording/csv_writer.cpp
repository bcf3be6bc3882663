#include "models/recording/csv_writer.hpp"

#include <algorithm>

#include "models/recording/number_writer.hpp"

namespace wems {
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
