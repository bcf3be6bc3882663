/// @file
/// Tests on cases drawn at random, some of which fail: the diagnosis' documentation says how often.
#pragma once

#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <random>
#include <string>

#include "tests/seed.hpp"

namespace wems::test {

/// Draws cases until `needed` of at most `most` are right, and fails if they are not. The numbers are such that at the
/// documented rates chance alone breaks a test once in some thousand runs.
/// @param run a case of a seed; returns what is wrong with its diagnosis, empty if nothing
inline void drawUntil(int needed, int most, const std::function<std::string(std::uint64_t)>& run) {
    std::mt19937_64 seeds(drawSeed());
    int right = 0, draws = 0;
    for (; draws < most && right < needed; ++draws) {
        const std::uint64_t seed = seeds();
        const std::string wrong = run(seed);
        if (wrong.empty()) {
            ++right;
        } else {
            WARN("seed " << seed << ": " << wrong);
        }
    }
    CAPTURE(draws);
    CHECK(right == needed);
}

}  // namespace wems::test
