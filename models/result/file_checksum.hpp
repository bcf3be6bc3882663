/// @file
/// What tells a file that was read from another one of the same name.
#pragma once

#include <optional>
#include <string>

namespace wems {

/// SHA-256 of a file's bytes (FIPS 180-4), 64 hexadecimal digits. Nothing for what cannot be read a second time: a
/// pipe, a device, a file that is gone.
std::optional<std::string> calcChecksum(const std::string& file);

}  // namespace wems
