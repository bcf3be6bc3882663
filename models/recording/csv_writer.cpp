#include "models/recording/csv_writer.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "models/atomic_file.hpp"
#include "models/error.hpp"
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

struct Column {
    const std::vector<double>* values;
    double factor;
    int digits;
};

std::vector<Column> makeColumns(const Recording& recording, const std::string& file, int digits, std::string& header) {
    std::vector<Column> columns{{&recording.time, 1.0, std::max(digits, kTimeDigits)}};
    header += "time [s]";
    for (const auto& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || channel.values.size() != recording.time.size())
            throw std::invalid_argument("writeCsv: channel '" + channel.name + "' has no valid name or length");
        const Quantity quantity = findQuantity(*name);
        const std::string unit = channel.unit.empty() ? siUnit(quantity) : channel.unit;
        columns.push_back({&channel.values, findUnitFactor(unit, quantity, {file, 0, channel.name}), digits});
        header += "," + quoteField(channel.name + " [" + unit + "]");
    }
    return columns;
}

}  // namespace

void writeCsv(const Recording& recording, const std::string& file, int digits) {
    std::string text;
    for (const auto& [key, value] : recording.metadata) text += "# " + oneLine(key) + ": " + oneLine(value) + "\n";
    const auto columns = makeColumns(recording, file, std::clamp(digits, 1, 17), text);
    text += '\n';

    AtomicFile target(file);
    std::ofstream stream(target.temporaryPath(), std::ios::binary | std::ios::trunc);
    const auto flush = [&] {
        stream.write(text.data(), static_cast<std::streamsize>(text.size()));
        text.clear();
    };
    for (std::size_t i = 0; i < recording.time.size(); ++i) {
        for (std::size_t j = 0; j < columns.size(); ++j) {
            if (j > 0) text += ',';
            appendNumber((*columns[j].values)[i] / columns[j].factor, columns[j].digits, text);
        }
        text += '\n';
        if (text.size() > kFlushSize) flush();
    }
    flush();
    stream.close();
    if (!stream) throw InputError({file, 0, {}}, "could not be written completely; is the disk full?");
    target.commit();
}

}  // namespace wems
