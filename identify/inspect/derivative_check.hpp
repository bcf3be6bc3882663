/// @file
/// Whether accelerations are the second derivatives of the displacements beside them.
#pragma once

#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

/// What the accelerations of points whose displacement was recorded, too, are of the second derivatives of those: the
/// ratio at the frequencies where both agree in course (coherence above 0.9 over Hann segments), its median. 1 within
/// the sensors' gains; 0.102 where g are labelled m/s^2, 10^6 where milliseconds are labelled seconds, below 0 where
/// one of them has the wrong sign.
/// @returns one sentence for all channels that share a ratio outside 0.67 to 1.5, which no sensor's gain explains;
///          nothing where too little is recorded to tell
std::vector<std::string> findContradictions(const Recording& recording);

}  // namespace wems::identify
