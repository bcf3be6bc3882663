/// @file
/// The modes file as text; reading it is in models/bracket.hpp.
#pragma once

#include <string>
#include <vector>

#include "models/bracket.hpp"

namespace wems {

/// The text of a modes file that reads back to the same modes; base columns only where a mode has some.
std::string formatBracketModes(const std::vector<BracketMode>& modes);

}  // namespace wems
