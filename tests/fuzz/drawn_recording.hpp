/// @file
/// Recordings that a laboratory hands over by mistake: a good one with oddities that a fuzzer's bytes choose.
#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/drawn_bytes.hpp"

namespace wems::fuzz {

/// A recording as a table: what no reader would hold, such as infinite or repeated stamps, can stand in it.
struct DrawnRecording {
    struct Column {
        std::string name, unit;
        std::vector<double> values;  ///< in `unit`; NaN is written as an empty field
    };
    std::vector<Column> columns;  ///< the first one is time

    std::string formatCsv() const;
};

/// Up to four oddities: channels dropped, scaled, still, repeated, reversed, clipped, noisy, moved in time, cells that
/// are no numbers or far too large, strange stamps, a wrong unit or name, few rows, coarse steps.
void makeOdd(DrawnRecording& recording, DrawnBytes& bytes);

/// Bytes flipped, cut or put in, in any text.
std::string damage(std::string text, DrawnBytes& bytes);

}  // namespace wems::fuzz
