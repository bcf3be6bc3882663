/// @file
/// What a fuzzer's bytes choose, one after the other: where they end, every choice is the first one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wems::fuzz {

class DrawnBytes {
public:
    DrawnBytes(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

    bool empty() const { return next_ == end_; }
    std::size_t byte() { return empty() ? 0 : *next_++; }
    /// Below `end`, which is at least 1.
    std::size_t below(std::size_t end) {
        const std::size_t high = end > 256 ? byte() : 0;
        return (256 * high + byte()) % end;
    }
    template <class Value, std::size_t size>
    const Value& pick(const std::array<Value, size>& values) {
        return values[below(size)];
    }

private:
    const std::uint8_t* next_;
    const std::uint8_t* end_;
};

}  // namespace wems::fuzz
