#include "models/recording/uff_function.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "models/common/error.hpp"

namespace wems {

namespace {

constexpr int kTimeAbscissa = 17;
constexpr std::size_t kMostPoints = std::size_t{1} << 33;

double readReal(std::string_view line, std::size_t from, std::size_t width, const std::string& file, long line_number) {
    const auto text = uffField(line, from, width);
    double value = 0;
    if (text.empty()) return 0;
    if (!parseUffReal(text, value))
        throw InputError({file, line_number, {}}, "'" + std::string(text) + "' is not a number");
    return value;
}

std::string withoutNone(std::string_view text) {
    return text == "NONE" ? std::string() : std::string(text);
}

/// Records 1 to 11.
void readHeader(LineCursor& lines, const std::string& file, UffFunction& function) {
    const auto next = [&] {
        if (lines.atEnd())
            throw InputError({file, lines.line(), {}}, "the file ends within the header of a dataset 58");
        return lines.take();
    };
    const auto integer = [&](std::string_view line, std::size_t from, std::size_t width) {
        return uffInteger(line, from, width, file, lines.line());
    };
    function.id = std::string(uffField(next(), 0, 80));
    for (int i = 0; i < 4; ++i) next();
    const auto dof = next();
    function.function_type = static_cast<int>(integer(dof, 0, 5));
    function.entity = withoutNone(uffField(dof, 31, 10));
    function.node = integer(dof, 41, 10);
    function.direction = static_cast<int>(integer(dof, 51, 4));
    const auto form = next();
    const long type = integer(form, 0, 10);
    const long points = integer(form, 10, 10);
    if (type != 2 && type != 4 && type != 5 && type != 6)
        throw InputError({file, lines.line(), {}}, std::to_string(type) + " is not a data type",
                         "2 (real, single), 4 (real, double), 5, 6 (complex)");
    if (points < 0 || static_cast<std::size_t>(points) > kMostPoints)
        throw InputError({file, lines.line(), {}}, std::to_string(points) + " points cannot be");
    function.even = integer(form, 20, 10) == 1;
    function.start = readReal(form, 30, 13, file, lines.line());
    function.step = readReal(form, 43, 13, file, lines.line());
    function.complex = type >= 5;
    function.double_precision = type == 4 || type == 6;
    function.points = static_cast<std::size_t>(points);
    const auto abscissa = next();
    function.abscissa_kind = static_cast<int>(integer(abscissa, 0, 10));
    function.abscissa_unit = withoutNone(uffField(abscissa, 47, 20));
    const auto ordinate = next();
    function.ordinate_kind = static_cast<int>(integer(ordinate, 0, 10));
    function.unit = withoutNone(uffField(ordinate, 47, 20));
    next();
    next();
}

/// Bytes up to the closing `-1`: as many as the header says, or, where that is wrong, up to the next such line; npos if
/// there is none.
std::size_t findBinaryLength(std::string_view rest, long stated) {
    constexpr std::string_view kMark = "    -1";
    const auto closesAt = [&](std::size_t at) {
        if (at > rest.size()) return false;
        const auto tail = rest.substr(at, 64);
        const auto first = tail.find_first_not_of("\r\n");
        return first != std::string_view::npos && tail.substr(first, kMark.size()) == kMark;
    };
    if (stated >= 0 && closesAt(stated)) return static_cast<std::size_t>(stated);
    for (auto at = rest.find(kMark); at != std::string_view::npos; at = rest.find(kMark, at + 1)) {
        const std::size_t end = at + kMark.size();
        const bool line_ends = end >= rest.size() || rest[end] == '\n' || rest[end] == '\r' || rest[end] == ' ';
        if (!line_ends) continue;
        while (at % 4 != 0 && (rest[at - 1] == '\n' || rest[at - 1] == '\r')) --at;  // the line end before the mark
        return at;
    }
    return std::string_view::npos;
}

}  // namespace

std::string_view uffField(std::string_view line, std::size_t from, std::size_t width) {
    if (from >= line.size()) return {};
    const auto field = line.substr(from, width);
    const auto first = field.find_first_not_of(" \t");
    return first == std::string_view::npos ? std::string_view{}
                                           : field.substr(first, field.find_last_not_of(" \t") - first + 1);
}

long uffInteger(std::string_view line, std::size_t from, std::size_t width, const std::string& file, long line_number) {
    auto text = uffField(line, from, width);
    if (text.empty()) return 0;
    if (text.front() == '+') text.remove_prefix(1);
    long value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    constexpr long largest = 1000000000000;
    if (result.ec != std::errc() || result.ptr != text.data() + text.size() || value > largest || value < -largest)
        throw InputError({file, line_number, {}}, "'" + std::string(text) + "' is not a whole number");
    return value;
}

bool UffFunction::isTimeResponse() const {
    const bool over_time = abscissa_kind == kTimeAbscissa;
    return !complex && (function_type == 1 || (function_type == 0 && over_time));
}

std::string UffFunction::name() const {
    static constexpr std::array<const char*, 7> kDirections = {"S", "X", "Y", "Z", "RX", "RY", "RZ"};
    const auto index = static_cast<std::size_t>(std::min(6, std::abs(direction)));
    std::string text = entity.empty() ? "" : entity + ":";
    text += std::to_string(node) + ":";
    if (index > 0) text += direction < 0 ? "-" : "+";
    return text + kDirections.at(index);
}

std::string UffFunction::kind() const {
    switch (ordinate_kind) {
        case 8:
            return "displacement";
        case 11:
            return "velocity";
        case 12:
            return "acceleration";
        case 9:
        case 13:
            return "force";
        default:
            return "kind " + std::to_string(ordinate_kind);
    }
}

double UffFunction::time(std::size_t point) const {
    if (!even) return abscissa[point];
    const double rate = std::round(1 / step);
    const double rounding = 0.5e-5 * std::pow(10.0, std::floor(std::log10(step)));
    const bool is_rate = rate >= 1 && std::abs(1 / rate - step) <= 1.001 * rounding;
    return start + (is_rate ? static_cast<double>(point) / rate : static_cast<double>(point) * step);
}

UffFunction readUffHeader(LineCursor& lines, const UffStorage& storage, const std::string& file, UffExtent& extent) {
    UffFunction function;
    readHeader(lines, file, function);
    if (function.points > lines.rest().size())
        throw InputError({file, lines.line(), {}},
                         "the file ends within a dataset 58 of " + std::to_string(function.points) + " points");
    extent.numbers = lines;
    extent.storage = storage;
    if (!storage.binary) return function;
    const std::size_t bytes = findBinaryLength(lines.rest(), storage.bytes);
    if (bytes == std::string_view::npos)
        throw InputError({file, lines.line(), {}},
                         "the file ends within the " + std::to_string(storage.bytes) + " bytes of a dataset 58b");
    if (function.isTimeResponse() && storage.floating_format != 2)
        throw InputError({file, lines.line(), {}}, "the numbers are in the binary format of DEC or IBM", "IEEE 754");
    extent.bytes = lines.rest().substr(0, bytes);
    lines.skip(bytes);
    return function;
}

UffFunction readUffFunction(LineCursor& lines, const UffStorage& storage, const std::string& file) {
    UffExtent extent;
    UffFunction function = readUffHeader(lines, storage, file, extent);
    if (!function.isTimeResponse()) return function;
    function.values.reserve(function.points);
    UffNumberReader reader(function, extent, file);
    reader.read(function.points, function);
    if (!storage.binary) lines = reader.cursor();
    return function;
}

namespace {

template <typename Word>
Word loadWord(const char* p, bool big_endian) {
    Word word = 0;
    for (std::size_t i = 0; i < sizeof(Word); ++i) {
        const auto byte = static_cast<Word>(static_cast<unsigned char>(p[big_endian ? i : sizeof(Word) - 1 - i]));
        word = static_cast<Word>((word << 8U) | byte);
    }
    return word;
}

double loadDouble(const char* p, bool big_endian) {
    const auto word = loadWord<std::uint64_t>(p, big_endian);
    double value = 0;
    std::memcpy(&value, &word, sizeof value);
    return value;
}

double loadSingle(const char* p, bool big_endian) {
    const auto word = loadWord<std::uint32_t>(p, big_endian);
    float value = 0;
    std::memcpy(&value, &word, sizeof value);
    return static_cast<double>(value);
}

}  // namespace

bool parseUffReal(std::string_view text, double& value) {
    if (text.empty()) return false;
    if (text.front() == '+') text.remove_prefix(1);
    const auto result = fast_float::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec == std::errc() && result.ptr == text.data() + text.size()) return true;
    std::string spelled;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool sign = c == '+' || c == '-';
        if (c == 'D' || c == 'd') {
            spelled += 'e';
        } else if (sign && i > 0 && std::isdigit(static_cast<unsigned char>(text[i - 1])) != 0) {
            spelled.append("e").append(1, c);
        } else {
            spelled += c;
        }
    }
    const auto again = fast_float::from_chars(spelled.data(), spelled.data() + spelled.size(), value);
    return again.ec == std::errc() && again.ptr == spelled.data() + spelled.size();
}

UffNumberReader::UffNumberReader(const UffFunction& shape, const UffExtent& extent, const std::string& file)
    : file_(file),
      lines_(extent.numbers),
      bytes_(extent.bytes),
      binary_(extent.storage.binary),
      big_endian_(extent.storage.big_endian),
      double_precision_(shape.double_precision),
      with_abscissa_(!shape.even),
      ordinates_(shape.complex ? 2 : 1),
      count_(shape.points * perPoint()) {}

void UffNumberReader::read(std::size_t points, UffFunction& function) {
    const std::size_t until = std::min(count_, points * perPoint());
    if (binary_) {
        readBinary(until, function);
        return;
    }
    while (read_ < until) readLine(function);
}

void UffNumberReader::readLine(UffFunction& function) {
    if (lines_.atEnd())
        throw InputError({file_, lines_.line(), {}}, "the file ends within a dataset 58: " + std::to_string(read_) +
                                                         " of " + std::to_string(count_) + " numbers are there");
    const auto line = lines_.take();
    std::size_t at = 0;
    while (read_ < count_) {
        if (at >= line.size()) break;
        const std::size_t width = double_precision_ && !isAbscissa() ? 20 : 13;
        const auto text = uffField(line, at, width);
        double value = 0;
        if (text.empty()) break;
        if (!parseUffReal(text, value))
            throw InputError({file_, lines_.line(), {}}, "'" + std::string(text) + "' is not a number",
                             "numbers of " + std::to_string(width) + " characters");
        take(value, function);
        at += width;
    }
    if (at == 0) throw InputError({file_, lines_.line(), {}}, "an empty line within the numbers of a dataset");
}

void UffNumberReader::readBinary(std::size_t until, UffFunction& function) {
    const bool all_double = bytes_.size() == 8 * count_, all_single = bytes_.size() == 4 * count_;
    while (read_ < until) {
        const bool wide = all_double || (!all_single && double_precision_ && !isAbscissa());
        const std::size_t width = wide ? 8 : 4;
        if (at_ + width > bytes_.size())
            throw InputError({file_, 0, {}}, "the binary part of a dataset 58 is shorter than its " +
                                                 std::to_string(count_) + " numbers need");
        const char* p = bytes_.data() + at_;
        take(wide ? loadDouble(p, big_endian_) : loadSingle(p, big_endian_), function);
        at_ += width;
    }
}

void UffNumberReader::take(double value, UffFunction& function) {
    if (isAbscissa()) {
        function.abscissa.push_back(value);
    } else if (ordinates_ == 1 || read_ % perPoint() == (with_abscissa_ ? 1U : 0U)) {
        function.values.push_back(value);
    }
    ++read_;
}

}  // namespace wems
