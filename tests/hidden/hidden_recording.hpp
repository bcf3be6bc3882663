/// @file
/// The recording of a hidden case's run, and the error that a model leaves on it.
#pragma once

#include "tests/hidden/random_case.hpp"

namespace wems::hidden {

/// In unit time. @param faults false: without the hidden faults of sensors, all else the same
Recording recordRun(const HiddenCase& hidden, std::size_t run, std::uint64_t seed, bool faults = true);

/// Squared difference and reference of relative displacements, summed.
struct ErrorSquares {
    double difference = 0, reference = 0;
    double error() const;
};

/// Free simulation of a model, driven by what was recorded (load, or motion of the table), against the recording in
/// unit time. Displacements alone where both ends have them; otherwise as displacements above 0.6 times the lowest
/// excited frequency. Infinite if it diverges.
ErrorSquares calcError(const HiddenCase& hidden, std::size_t run, const MountModel& model, const OutsideEffect& outside,
                       const Recording& recording);

}  // namespace wems::hidden
