/// @file
/// A file's bytes.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace wems {

// Other encodings to UTF-8.

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

/// True if `text` is UTF-8: no overlong codes, no surrogates, none beyond U+10FFFF (Unicode, table 3-7).
inline bool isUtf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i++]);
        if (lead < 0x80) continue;
        if (lead < 0xC2 || lead > 0xF4) return false;
        unsigned char lowest = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;  // of the second byte
        unsigned char highest = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
        for (int more = lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3; more > 0; --more, ++i) {
            if (i >= text.size()) return false;
            const auto byte = static_cast<unsigned char>(text[i]);
            if (byte < lowest || byte > highest) return false;
            lowest = 0x80;
            highest = 0xBF;
        }
    }
    return true;
}

/// Text that is no UTF-8 is taken for Latin-1.
inline std::string decodeLatin1(std::string_view text) {
    if (isUtf8(text)) return std::string(text);
    std::string decoded;
    for (const char c : text) appendUtf8(static_cast<unsigned char>(c), decoded);
    return decoded;
}

/// The first `most` bytes of UTF-8 text, fewer where a character would be cut, and `…` where more follows.
inline std::string cutUtf8(const std::string& text, std::size_t most) {
    if (text.size() <= most) return text;
    while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0U) == 0x80U) --most;
    return text.substr(0, most) + " …";
}

/// `text` without the mark by which some programs begin a UTF-8 file.
inline std::string_view skipByteOrderMark(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    return text;
}

class TextFile {
public:
    /// When the file is read.
    enum class Pages {
        all,       ///< at once
        as_needed  ///< mapped into memory, read where view() is looked at; release() gives the memory back
    };
    /// @throws InputError: not there, not readable, a directory or another thing that is no file, empty, changed while
    ///         it was read.
    explicit TextFile(const std::string& file, Pages pages = Pages::all);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    std::string_view view() const { return view_; }
    /// Gives the memory back that was taken so far; what is looked at again is read again.
    /// @throws InputError if the file was changed since it was opened
    void release() const;

private:
    class Descriptor {
    public:
        explicit Descriptor(int value) : value_(value) {}
        ~Descriptor();
        Descriptor(const Descriptor&) = delete;
        Descriptor& operator=(const Descriptor&) = delete;
        int get() const { return value_; }

    private:
        int value_;
    };
    void checkUnchanged() const;

    std::string file_;
    Descriptor descriptor_;
    struct stat status_ {};  // when it was opened
    std::string_view view_;
    void* mapping_ = nullptr;
    std::string copy_;  // where the file cannot be mapped, such as a pipe
};

}  // namespace wems
