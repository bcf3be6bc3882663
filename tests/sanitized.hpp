/// @file
/// Whether the tests run under sanitizers, where every access is checked and all takes ten times as long: repetitions
/// of the same code with other numbers are left to the optimised build.
#pragma once

namespace wems::test {

#ifdef WEMS_SANITIZED
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

}  // namespace wems::test
