/// @file
/// Uniform signals at other times, without aliasing.
#pragma once

#include <vector>

namespace wems::identify {

/// A uniform signal: sample k at start + k · interval.
struct UniformSignal {
    double start = 0, interval = 0;  ///< s
    std::vector<double> values;

    double end() const { return start + interval * static_cast<double>(values.size() - 1); }
};

/// `signal` at start + k · interval, k < count: a sinc of 32 zero crossings on each side under a Kaiser window (β = 8),
/// cut so that the stop band (80 dB) begins at half of the lower of both rates; flat within 0.1 % up to 0.42 of it. At
/// the ends, where half of the sinc finds no samples, weights are scaled to keep a constant.
/// @param count chosen so that all times lie within the signal
UniformSignal resample(const UniformSignal& signal, double start, double interval, std::size_t count);

}  // namespace wems::identify
