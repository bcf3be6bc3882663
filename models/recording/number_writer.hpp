/// @file
/// Numbers of recordings as text: what the writers of text formats share.
#pragma once

#include <cstddef>
#include <string>

#include "models/recording/recording.hpp"

namespace wems {

inline constexpr int kTimeDigits = 12;                           // of the time column at least
inline constexpr std::size_t kFlushSize = std::size_t{1} << 20;  // bytes of text that are written at once

/// Appends with so many significant digits; nothing for a NaN, which is a gap. Throws std::invalid_argument if
/// infinite.
void appendNumber(double value, int digits, std::string& text);

/// The parts of the channel's name. Throws std::invalid_argument if it is none.
ChannelName parseValidName(const Channel& channel);
/// Throws std::invalid_argument unless there are so many channels, each as long as time.
void checkRows(const Recording& rows, std::size_t channel_count);

}  // namespace wems
