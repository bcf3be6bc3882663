/// @file
/// Compressed data as they are without compression.
#pragma once

#include <string>
#include <string_view>

namespace wems {

/// What a zlib stream holds.
struct Inflated {
    std::string plain;      ///< as far as the stream goes
    bool complete = false;  ///< the stream reached its end and its checksum is right
};

/// The memory taken is that of the result, at most 1032 times the stream (deflate's limit), whatever other numbers
/// claim.
Inflated inflateAll(std::string_view stream);

}  // namespace wems
