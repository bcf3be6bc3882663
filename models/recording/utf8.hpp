/// @file
/// Other encodings to UTF-8.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

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

/// UTF-16 text with its byte-order mark as UTF-8, characters beyond the basic plane as `?`; empty if `text` does not
/// begin with such a mark.
inline std::string decodeUtf16(std::string_view text) {
    std::string decoded;
    const bool little = text.substr(0, 2) == "\xFF\xFE";
    if (!little && text.substr(0, 2) != "\xFE\xFF") return decoded;
    decoded.reserve(text.size() / 2);
    for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
        const auto low = static_cast<unsigned char>(text[little ? i : i + 1]);
        const auto high = static_cast<unsigned char>(text[little ? i + 1 : i]);
        const auto code = static_cast<std::uint32_t>(high << 8U | low);
        const bool surrogate = code >= 0xD800 && code < 0xE000;
        if (!surrogate) appendUtf8(code, decoded);
        if (surrogate && code < 0xDC00) decoded += '?';
    }
    return decoded;
}

/// `text` without the mark by which some programs begin a UTF-8 file.
inline std::string_view skipByteOrderMark(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    return text;
}

}  // namespace wems
