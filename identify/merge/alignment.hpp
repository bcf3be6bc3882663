/// @file
/// How much later one recording's clock is than another's, from a channel that both have.
#pragma once

#include "identify/merge/resampling.hpp"

namespace wems::identify {

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

}  // namespace wems::identify
