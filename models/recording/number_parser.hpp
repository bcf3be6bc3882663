/// @file
/// Short decimal numbers, eight characters at a time.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace wems {

/// Parses a number such as `-12.3456` or `1.5e-3` that starts at `p`.
///
/// A number of at most 15 digits with a power of ten within ±22 is m · 10^e with m and 10^e both exact in double
/// precision, so that one multiplication or division rounds correctly (Clinger, How to read floating point numbers
/// accurately, PLDI 1990). Anything else is left to the general parser.
/// @returns the end of the number; nullptr if it is of another kind (longer, with a `+`, `nan`, no number, or too near
///          to `end` to load eight bytes).
class NumberParser {
public:
    explicit NumberParser(char decimal, char separator = ',') : decimal_(decimal), separator_(separator) {
        separators_.fill(separator);
        decimals_.fill(decimal);
    }

    /// Parses a whole field, up to a separator or line end. The end of the field is found first, without looking at the
    /// digits, so that the processor works on several fields at once.
    /// Eight bytes before `p` must be readable.
    /// @returns the field's end; nullptr if the field holds anything but such a number.
    const char* parseField(const char* p, const char* end, double& value) const {
#ifdef __SSE2__
        if (end - p < 48) return nullptr;
        const __m128i chunk = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
        const auto load16 = [](const char* q) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(q)); };
        const auto find = [&](__m128i c) { return _mm_cmpeq_epi8(chunk, c); };
        const auto ends = static_cast<unsigned>(_mm_movemask_epi8(_mm_or_si128(
            find(load16(separators_.data())), _mm_or_si128(find(_mm_set1_epi8('\n')), find(_mm_set1_epi8('\r'))))));
        if (ends != 0) {
            const int length = __builtin_ctz(ends);
            const unsigned dots =
                static_cast<unsigned>(_mm_movemask_epi8(find(load16(decimals_.data())))) & ((1U << length) - 1);
            const int dot = dots != 0 ? __builtin_ctz(dots) : length;
            const int negative = *p == '-';
            const int whole = dot - negative, fraction = length - dot - (dots != 0);
            if (whole >= 0 && whole <= 7 && fraction >= 0 && fraction <= 8 && whole + fraction > 0) {
                const std::uint64_t high = alignDigits(p + negative, whole), low = alignDigits(p + dot + 1, fraction);
                if (areDigits(high) && areDigits(low)) {
                    const std::uint64_t mantissa = joinDigits(high) * kWholePowers[fraction] + joinDigits(low);
                    value =
                        static_cast<double>(static_cast<std::int64_t>(mantissa)) / kPowers[fraction] * kSigns[negative];
                    return p + length;
                }
            }
        }
#endif
        p = parse(p, end, value);
        return p != nullptr && (*p == separator_ || *p == '\n' || *p == '\r') ? p : nullptr;
    }

    const char* parse(const char* p, const char* end, double& value) const {
        if (end - p < 48) return nullptr;  // five loads at most, so no further test is needed below
        const bool negative = *p == '-';
        p += negative;
        std::uint64_t mantissa = 0;
        const int whole = takeDigits(p, mantissa);
        if (whole == 8) return nullptr;
        p += whole;
        int fraction = 0;
        if (*p == decimal_) {
            ++p;
            fraction = takeDigits(p, mantissa);
            p += fraction;
            if (fraction == 8) {
                const int more = takeDigits(p, mantissa);
                p += more;
                fraction += more;
            }
        }
        const int digits = whole + fraction;
        if (digits == 0 || digits > 15) return nullptr;
        int power = -fraction;
        if ((*p | 0x20) == 'e') {
            ++p;
            const bool below = *p == '-';
            p += below || *p == '+';
            std::uint64_t exponent = 0;
            const int count = takeDigits(p, exponent);
            if (count == 0 || count > 3) return nullptr;
            p += count;
            power += below ? -static_cast<int>(exponent) : static_cast<int>(exponent);
            if (power < -22 || power > 22) return nullptr;
        }
        double number = static_cast<double>(static_cast<std::int64_t>(mantissa));
        if (power < 0) {
            number /= kPowers[static_cast<std::size_t>(-power)];
        } else {
            number *= kPowers[static_cast<std::size_t>(power)];
        }
        value = number * kSigns[negative];  // a branch would be mispredicted half the time
        return p;
    }

private:
    static constexpr std::array<double, 2> kSigns = {1.0, -1.0};
    static constexpr std::array<double, 23> kPowers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                       1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                       1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    static constexpr std::array<std::uint64_t, 9> kWholePowers = {1,      10,      100,      1000,     10000,
                                                                  100000, 1000000, 10000000, 100000000};

    static constexpr std::uint64_t kThrees = 0x3030303030303030U;

    /// Appends the digits at `p`, eight at most, to `number`; returns how many there were.
    static int takeDigits(const char* p, std::uint64_t& number) {
        const std::uint64_t word = load(p);
        // A byte is a digit if its high half is 3 and stays 3 when 6 is added.
        constexpr std::uint64_t kHigh = 0xF0F0F0F0F0F0F0F0U;
        const std::uint64_t other = ((word & kHigh) ^ kThrees) | (((word + 0x0606060606060606U) & kHigh) ^ kThrees);
        const int count = other == 0 ? 8 : __builtin_ctzll(other) / 8;
        if (count == 0) return 0;
        number = number * kWholePowers[count] + joinDigits((word ^ kThrees) << (64 - 8 * count));
        return count;
    }

    /// The values of `count` digits at the end of a word, zeros before them.
    static std::uint64_t alignDigits(const char* p, int count) {
        constexpr std::array<std::uint64_t, 9> masks = {0,
                                                        0xFF00000000000000U,
                                                        0xFFFF000000000000U,
                                                        0xFFFFFF0000000000U,
                                                        0xFFFFFFFF00000000U,
                                                        0xFFFFFFFFFF000000U,
                                                        0xFFFFFFFFFFFF0000U,
                                                        0xFFFFFFFFFFFFFF00U,
                                                        0xFFFFFFFFFFFFFFFFU};
        return (load(p + count - 8) ^ kThrees) & masks[count];
    }

    static bool areDigits(std::uint64_t values) {
        constexpr std::uint64_t high_bits = 0x8080808080808080U;
        return (((values + 0x7676767676767676U) | values) & high_bits) == 0;
    }

    /// Pairs, then fours, then eights.
    static std::uint64_t joinDigits(std::uint64_t values) {
        values = values * 10 + (values >> 8);
        return (((values & 0x000000FF000000FFU) * 0x000F424000000064U) +
                (((values >> 16) & 0x000000FF000000FFU) * 0x0000271000000001U)) >>
               32;
    }

    /// Eight bytes, the first one lowest.
    static std::uint64_t load(const char* p) {
        std::uint64_t word = 0;
        std::memcpy(&word, p, sizeof word);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
        word = __builtin_bswap64(word);
#endif
        return word;
    }

    char decimal_, separator_;
    std::array<char, 16> separators_{}, decimals_{};
};

}  // namespace wems
