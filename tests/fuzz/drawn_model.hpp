/// @file
/// Models that nobody means: a good one whose numbers, lines and tables a fuzzer's bytes change.
#pragma once

#include <string>

#include "tests/fuzz/drawn_bytes.hpp"

namespace wems::fuzz {

/// Up to four oddities: numbers replaced or scaled, lines left out or repeated, laws and tables that are not in it.
std::string makeOddModel(std::string toml, DrawnBytes& bytes);

}  // namespace wems::fuzz
