/// @file
/// Short spectra of a signal along time.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace wems::identify {

/// Discrete Fourier transforms of half-overlapping Hann segments of `length` samples; values that are not finite count
/// as zero. One vector of length/2 + 1 bins for each segment.
std::vector<std::vector<std::complex<double>>> transformSegments(const std::vector<double>& signal, std::size_t length);

}  // namespace wems::identify
