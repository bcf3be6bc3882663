#include "models/recording/number_writer.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace wems {

void appendNumber(double value, int digits, std::string& text) {
    if (std::isnan(value)) return;
    if (std::isinf(value)) throw std::invalid_argument("writeRecording: a value is infinite");
    std::array<char, 32> number{};
    const auto result =
        std::to_chars(number.data(), number.data() + number.size(), value, std::chars_format::general, digits);
    text.append(number.data(), result.ptr);
}

}  // namespace wems
