/// @file
/// Tests that sanitizers make too slow.
#pragma once

#include <catch2/catch.hpp>

#include "tests/sanitized.hpp"

namespace wems::test {

/// True, said aloud, where every access is checked: diagnosing recordings of 10 to 40 s takes minutes there.
inline bool isTooSlow() {
    if (kSanitized) WARN("skipped: too slow with sanitizers");
    return kSanitized;
}

}  // namespace wems::test
