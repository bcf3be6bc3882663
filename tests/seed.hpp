/// @file
/// The seed of a test's random draws.
#pragma once

#include <cstdlib>
#include <random>
#include <string>

namespace wems::test {

/// Always the same, so that a failure comes again, unless the environment says `WEMS_SEED=random` or a number
/// (scripts/random_tests). A test that draws prints its seed where it fails.
inline unsigned drawSeed() {
    const char* wanted = std::getenv("WEMS_SEED");
    if (wanted == nullptr) return 1;
    if (std::string(wanted) == "random") return std::random_device{}();
    return static_cast<unsigned>(std::stoul(wanted));
}

inline bool isSeedFixed() {
    return std::getenv("WEMS_SEED") == nullptr;
}

}  // namespace wems::test
