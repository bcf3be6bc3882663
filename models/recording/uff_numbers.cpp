#include "models/recording/uff_numbers.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>

#include "models/error.hpp"

namespace wems {
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
