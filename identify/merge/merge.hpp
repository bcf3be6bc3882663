/// @file
/// Several recordings of one run as one: common time, common rate.
#pragma once

#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems::identify {

// Uniform signals at other times, without aliasing.

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

// How much later one recording's clock is than another's, from a channel that both have.

struct Alignment {
    double shift = 0;        ///< s: to be added to the second signal's times
    double deviation = 0;    ///< s, standard error of the shift, from what remains
    double gain = 1;         ///< second over first
    double correlation = 0;  ///< of both after the shift, where they overlap
    double drift = 0;  ///< s: shift of the last third less that of the first, beyond the start; 0 if not significant
};

/// Cross-correlation over all lags at the lower of both rates (Fourier transform), then Gauss–Newton steps for gain and
/// shift where both overlap, down to a small part of a sample.
Alignment align(const UniformSignal& first, const UniformSignal& second);

struct MergeOptions {
    std::string common;  ///< channel of all recordings that aligns them; empty: their time stamps are taken as they are
    double rate = 0;     ///< Hz; 0: the lowest of all
};

/// The common channel as one recording has it, on the first one's clock.
struct AlignedChannel {
    std::string file;
    UniformSignal signal;
};

struct MergedRecording {
    Recording recording;
    std::vector<AlignedChannel> common;  ///< of each recording; none without common channel
};

/// Channels of all recordings over the time that they share, on the first one's clock, resampled without aliasing
/// (below). Of the common channel the first one's is kept. What was shifted by how much stands in `warnings`.
/// @throws InputError: fewer than two recordings, a channel twice, no common channel, no overlap, the common channels
///         do not match (correlation below 0.5)
MergedRecording merge(const std::vector<Recording>& recordings, const MergeOptions& options);

}  // namespace wems::identify
