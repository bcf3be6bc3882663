#include "models/recording/lvm_reader.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"

namespace wems {

namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";
constexpr std::size_t kLongestQuote = 40;  // characters of a file in a message
constexpr double kNotableStepError = 1e-5;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

using Settings = std::map<std::string, std::vector<std::string>>;

std::string_view trimField(std::string_view text) {
    const auto first = text.find_first_not_of(" \r\t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \r\t") - first + 1);
}

/// Fields of a row of a header, trimmed.
std::vector<std::string> splitRow(std::string_view line, char separator) {
    std::vector<std::string> fields;
    for (;;) {
        const auto end = line.find(separator);
        fields.emplace_back(trimField(line.substr(0, end)));
        if (end == std::string_view::npos) return fields;
        line.remove_prefix(end + 1);
    }
}

bool isBlank(std::string_view line, char separator) {
    return std::all_of(line.begin(), line.end(),
                       [&](char c) { return c == separator || c == ' ' || c == '\t' || c == '\r'; });
}

/// Of a whole field; nullopt if it is anything but a number.
std::optional<double> parseNumber(std::string_view text, char decimal) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const fast_float::parse_options options(fast_float::chars_format::general, decimal);
    const auto result = fast_float::from_chars_advanced(text.data(), text.data() + text.size(), value, options);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Keys and values of a header, up to its end; blocks for other programs' use are passed over.
Settings readSettings(LineCursor& lines, char separator, const std::string& file) {
    Settings settings;
    bool special = false;
    for (;;) {
        if (lines.atEnd()) throw InputError({file, 0, {}}, "the file ends within a header", std::string(kEndOfHeader));
        const std::string_view line = lines.take();
        if (line.substr(0, kEndOfHeader.size()) == kEndOfHeader) return settings;
        auto fields = splitRow(line, separator);
        if (fields[0] == "***Start_Special***") special = true;
        if (!special && !fields[0].empty()) settings[fields[0]] = fields;
        if (fields[0] == "***End_Special***") special = false;
    }
}

/// Field of a setting, empty where it is not there.
std::string valueOf(const Settings& settings, const std::string& key, std::size_t field = 1) {
    const auto found = settings.find(key);
    return found != settings.end() && field < found->second.size() ? found->second[field] : std::string();
}

/// The separator of the file's own header, before any setting tells it.
char findSeparator(std::string_view text) {
    const auto at = text.find("\nSeparator");
    const auto end = at == std::string_view::npos ? at : at + std::string_view("\nSeparator").size();
    return end < text.size() && text[end] == ',' ? ',' : '\t';
}

LvmRowForm readForm(const Settings& settings, char separator, const InputLocation& location) {
    LvmRowForm form;
    form.separator = separator;
    const std::string stated = valueOf(settings, "Separator");
    if (!stated.empty() && stated != (separator == ',' ? "Comma" : "Tab"))
        throw InputError({location.file, location.line, "Separator"}, "is '" + stated + "', which the header is not",
                         "Tab, Comma");
    const std::string decimal = valueOf(settings, "Decimal_Separator");
    if (decimal.size() > 1 || decimal.find_first_not_of(".,") != std::string::npos || decimal[0] == separator)
        throw InputError({location.file, location.line, "Decimal_Separator"}, "is '" + decimal + "'",
                         separator == ',' ? "a point, as commas separate" : "a point or a comma");
    if (!decimal.empty()) form.decimal = decimal[0];
    const std::string times = valueOf(settings, "X_Columns");
    if (times == "No") {
        form.times = LvmRowForm::Times::none;
    } else if (times == "Multi") {
        form.times = LvmRowForm::Times::each;
    } else if (times != "One" && !times.empty()) {
        throw InputError({location.file, location.line, "X_Columns"}, "is '" + times + "'", "No, One, Multi");
    }
    return form;
}

/// X0 or Delta_X, which all channels share.
double readShared(const Settings& segment, const std::string& key, const LvmRowForm& form,
                  const InputLocation& location) {
    std::optional<double> shared;
    for (std::size_t i = 0; i < form.channels; ++i) {
        const std::string text = valueOf(segment, key, form.fieldOf(i));
        const auto value = parseNumber(text, form.decimal);
        if (!value || !std::isfinite(*value))
            throw InputError(
                {location.file, location.line, key},
                "'" + text.substr(0, kLongestQuote) + "', of channel " + std::to_string(i + 1) + ", is not a number");
        if (shared && *shared != *value)
            throw InputError({location.file, location.line, key},
                             "channel " + std::to_string(i + 1) + " has another one than the channels before it",
                             "channels of one clock, or X_Columns Multi");
        shared = value;
    }
    return *shared;
}

/// LabVIEW writes the step with few decimals, 0.000977 for 1/1024 s: the share that rounding may be wrong by, half a
/// unit of the last digit. None where the rate is a whole number, which is hardly chance.
double calcStepError(const std::string& text, const LvmRowForm& form) {
    constexpr double whole = 1e-9;
    const double rate = 1 / form.interval;
    if (std::abs(rate - std::round(rate)) < whole * rate) return 0;
    const auto mantissa = text.substr(0, text.find_first_of("eE"));
    const auto point = mantissa.find(form.decimal);
    const double decimals = point == std::string::npos ? 0 : static_cast<double>(mantissa.size() - point - 1);
    const auto exponent = mantissa.size() < text.size() ? parseNumber(text.substr(mantissa.size() + 1), '.') : 0.0;
    return 0.5 * std::pow(10, exponent.value_or(0) - decimals) / form.interval;
}

void readChannels(const Settings& segment, const std::vector<std::string>& names, LvmHeader& header) {
    RecordingTable& table = header.table;
    LvmRowForm& form = header.form;
    const InputLocation location{table.file, table.header_row, "Channels"};
    const auto count = parseNumber(valueOf(segment, "Channels"), '.');
    if (!count || !(*count >= 1))
        throw InputError(location, "'" + valueOf(segment, "Channels").substr(0, kLongestQuote) + "' is no count",
                         "1 or more");
    const bool multi = form.times == LvmRowForm::Times::each;
    const auto room = static_cast<double>(multi ? names.size() / 2 : names.size() - 1);
    if (*count != std::floor(*count) || *count > room)
        throw InputError(location, "the header counts channels that the row of their names does not have",
                         "a name for each of " + valueOf(segment, "Channels").substr(0, kLongestQuote));
    form.channels = static_cast<std::size_t>(*count);
    table.columns.push_back({kTime, std::string("s"), {"X_Value"}});
    for (std::size_t i = 0; i < form.channels; ++i) {
        const std::size_t field = form.fieldOf(i);
        const std::string dimension = valueOf(segment, "X_Dimension", field),
                          unit = valueOf(segment, "Y_Unit_Label", field);
        if (!dimension.empty() && dimension != "Time")
            throw InputError({table.file, table.header_row, "X_Dimension"},
                             "of '" + names[field] + "' is '" + dimension.substr(0, kLongestQuote) + "'", "Time");
        table.columns.push_back({names[field], unit.empty() ? std::nullopt : std::make_optional(unit), {}});
    }
}

/// The rows of one segment, taken apart in place.
class LvmRowParser {
public:
    LvmRowParser(const LvmRowForm& form, const std::string& file) : form_(form), file_(file), row_(1 + form.channels) {}

    /// Time, then channels.
    const std::vector<double>& parse(std::string_view line, long number, std::size_t sample) {
        std::fill(row_.begin(), row_.end(), kNoNumber);
        if (form_.times == LvmRowForm::Times::none)
            row_[0] = form_.start + form_.interval * static_cast<double>(sample);
        const bool multi = form_.times == LvmRowForm::Times::each;
        const std::size_t fields = form_.fieldOf(form_.channels - 1) + 1;
        for (std::size_t field = 0; field < fields; ++field) {
            const auto end = line.find(form_.separator);
            const auto text = trimField(line.substr(0, end));
            const bool of_time = multi ? field % 2 == 0 : field == 0;
            if (!text.empty() && !(of_time && form_.times == LvmRowForm::Times::none)) {
                const auto value = parseNumber(text, form_.decimal);
                if (!value)
                    throw InputError({file_, number, {}}, "'" + std::string(text.substr(0, kLongestQuote)) +
                                                              "', field " + std::to_string(field + 1) +
                                                              " of the row, is not a number");
                if (of_time) {
                    setTime(*value, number, field);
                } else {
                    row_[multi ? (field + 1) / 2 : field] = *value;
                }
            }
            if (end == std::string_view::npos) break;
            line.remove_prefix(end + 1);
        }
        return row_;
    }

private:
    void setTime(double value, long number, std::size_t field) {
        if (!std::isnan(row_[0]) && row_[0] != value)
            throw InputError({file_, number, {}},
                             "channel " + std::to_string(field / 2 + 1) + " has another time than those before it",
                             "channels of one clock");
        row_[0] = value;
    }

    const LvmRowForm& form_;
    const std::string& file_;
    std::vector<double> row_;
};

}  // namespace

bool isLvm(std::string_view text) {
    constexpr std::string_view kBeginning = "LabVIEW Measurement";
    return text.substr(0, kBeginning.size()) == kBeginning;
}

LvmHeader readLvmHeader(LineCursor& lines, const std::string& file) {
    const char separator = findSeparator(lines.rest().substr(0, lines.rest().find(kEndOfHeader)));
    LvmHeader header;
    RecordingTable& table = header.table;
    table.file = file;
    table.format = "LabVIEW .lvm";
    lines.take();
    const Settings settings = readSettings(lines, separator, file);
    header.form = readForm(settings, separator, {file, lines.line(), {}});
    const Settings segment = readSettings(lines, separator, file);
    for (const auto* part : {&settings, &segment})
        for (const char* key : {"Operator", "Description", "Project", "Date", "Time", "Test_Name", "Notes"})
            if (const std::string value = valueOf(*part, key); !value.empty()) table.metadata[key] = value;
    const auto names = splitRow(lines.take(), separator);
    table.header_row = lines.line();
    if (names[0] != "X_Value")
        throw InputError({file, lines.line(), {}}, "the row of the channels' names does not begin with X_Value");
    readChannels(segment, names, header);
    if (header.form.times == LvmRowForm::Times::none) {
        const InputLocation location{file, table.header_row, {}};
        header.form.start = readShared(segment, "X0", header.form, location);
        header.form.interval = readShared(segment, "Delta_X", header.form, location);
        if (!(header.form.interval > 0))
            throw InputError({file, table.header_row, "Delta_X"}, "the time step is not above zero");
        const std::string step = valueOf(segment, "Delta_X", header.form.fieldOf(0));
        if (const double error = calcStepError(step, header.form); error > kNotableStepError)
            table.warnings.push_back("Delta_X " + step + " is rounded: the sampling rate is known to " +
                                     formatNumber(100 * error, 2) + " % only");
    }
    if (header.form.times == LvmRowForm::Times::none) {
        const auto packet = parseNumber(valueOf(segment, "Samples"), '.');
        if (packet && *packet >= 1 && *packet < 1e15) header.form.packet = static_cast<std::size_t>(*packet);
    }
    table.first_row = lines.line() + 1;
    return header;
}

std::vector<std::vector<double>> readLvmRows(LineCursor& lines, const LvmRowForm& form, const std::string& file,
                                             std::size_t first_sample, std::size_t most) {
    std::vector<std::vector<double>> values(1 + form.channels);
    LvmRowParser parser(form, file);
    for (std::size_t rows = 0; rows < most && !lines.atEnd(); ++rows) {
        const std::string_view line = lines.take();
        if (isBlank(line, form.separator)) {
            const long blank = lines.line();
            while (!lines.atEnd()) {
                if (isBlank(lines.take(), form.separator)) continue;
                if (lines.rest().find(kEndOfHeader) == std::string_view::npos)
                    throw InputError({file, blank, {}}, "blank row inside the data");
                throw InputError({file, lines.line(), {}}, "a further segment begins", "one segment to a file");
            }
            break;
        }
        const auto& row = parser.parse(line, lines.line(), first_sample + rows);
        for (std::size_t j = 0; j < values.size(); ++j) values[j].push_back(row[j]);
    }
    return values;
}

std::string describePackets(const LvmRowForm& form) {
    return "packets of " + std::to_string(form.packet) +
           " samples stand on end without times between them; they are taken as one run without gaps";
}

RecordingTable readLvm(std::string_view text, const std::string& file) {
    LineCursor lines(text);
    LvmHeader header = readLvmHeader(lines, file);
    header.table.values = readLvmRows(lines, header.form, file);
    if (header.form.packet > 0 && header.table.values.front().size() > header.form.packet)
        header.table.warnings.push_back(describePackets(header.form));
    return std::move(header.table);
}

LvmRows::LvmRows(const std::string& file, const ColumnMap* map)
    : text_(file, TextFile::Pages::as_needed), lines_(skipByteOrderMark(text_.view())) {
    LvmHeader header = readLvmHeader(lines_, file);
    form_ = header.form;
    if (form_.packet > 0 && exceedsPacket()) header.table.warnings.push_back(describePackets(form_));
    plan_ = planTable(header.table, map);
    expected_samples_ = estimateRows(lines_.rest());
}

/// Walks over the first packet.
bool LvmRows::exceedsPacket() const {
    LineCursor rows = lines_;
    for (std::size_t k = 0; k < form_.packet; ++k) {
        if (rows.atEnd()) return false;
        rows.take();
        if (k % kRowsAtOnce == 0) text_.release();
    }
    return rows.rest().find_first_not_of(" \t\r\n,") != std::string_view::npos;
}

bool LvmRows::append(Recording& rows) {
    if (lines_.atEnd()) return false;
    auto values = readLvmRows(lines_, form_, plan_.recording.file, samples_read_, kRowsAtOnce);
    samples_read_ += values.front().size();
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, std::move(values[plan_.columns[k].index]), rows);
    text_.release();
    return true;
}

}  // namespace wems
