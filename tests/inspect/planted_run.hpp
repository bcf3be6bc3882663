// Recordings of a swept oscillator with one defect planted at random.
#pragma once

#include <random>
#include <string>

#include "models/recording/recording.hpp"

namespace wems::test {

/// Four channels at 500 to 2000 Hz: the load, a displacement that leaves the middle and bends near a random resonance
/// (stops on one side), its acceleration, and another axis of small motion; white noise of 60 to 90 dB below the
/// signal. The recording begins and ends at rest in half of the cases.
Recording makeSweptRun(std::mt19937& random);

/// What is wrong, and where.
struct Planted {
    FindingKind kind = FindingKind::gap;
    std::string channel;  ///< `time` for stamps
    std::string what;     ///< size, for messages
};

/// The kinds that plant() knows.
constexpr int kind_count = 8;
const char* plantedName(int kind);

/// Plants defect `kind` (0 to kind_count − 1) of random size and place.
Planted plant(int kind, Recording& recording, std::mt19937& random);

}  // namespace wems::test
