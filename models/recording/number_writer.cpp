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

}  // namespace wems
