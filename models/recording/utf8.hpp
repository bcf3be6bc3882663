/// @file
/// Character codes to UTF-8.
#pragma once

#include <cstdint>
#include <string>

namespace wems {

/// Appends a code of the basic plane (up to U+FFFF).
inline void appendUtf8(std::uint32_t code, std::string& text) {
    if (code < 0x80) {
        text += static_cast<char>(code);
    } else if (code < 0x800) {
        text += static_cast<char>(0xC0U | (code >> 6U));
        text += static_cast<char>(0x80U | (code & 0x3FU));
    } else {
        text += static_cast<char>(0xE0U | ((code >> 12U) & 0x0FU));
        text += static_cast<char>(0x80U | ((code >> 6U) & 0x3FU));
        text += static_cast<char>(0x80U | (code & 0x3FU));
    }
}

}  // namespace wems
