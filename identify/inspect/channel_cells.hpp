/// @file
/// The channels of a rigid part as accelerations, in cells of time and frequency.
///
/// All channels of a part, displacements and accelerations alike, tell of the same six motions m: the acceleration of
/// channel c is d_c · m at each time and frequency, whatever the device does. Displacements enter by their second
/// difference, whose gain is corrected in each cell, so that both kinds stand side by side.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// Short spectra of a signal along time.

/// Discrete Fourier transforms of half-overlapping Hann segments of `length` samples; values that are not finite count
/// as zero. One vector of length/2 + 1 bins for each segment.
std::vector<std::vector<std::complex<double>>> transformSegments(const std::vector<double>& signal, std::size_t length);

struct CellChannel {
    std::string name, station;  ///< station: `mobile.1`, `base`
    Derivative derivative = Derivative::displacement;
    int axis = 0;
    Eigen::Matrix<double, 1, 6> row;  ///< d_c: of (acceleration of the origin, angular acceleration · 0.1 m) at rest
};

/// A band of frequencies in a segment of time.
struct Cell {
    double time = 0;        ///< s, of its middle, from the middle of the recording
    double omega = 0;       ///< rad/s, mean over power
    Eigen::MatrixXcd S;     ///< Σ X X* over its bins, accelerations as recorded
    Eigen::VectorXd noise;  ///< what the channels' noise alone gives to the diagonal of S
};

struct PartCells {
    std::vector<CellChannel> channels;
    std::vector<Cell> cells;
    double interval = 0;  ///< s, between samples
    int redundancy = 0;   ///< channels beyond the motions that they determine
};

/// @param recording uniformly sampled @param part mobile or fixed; without a bracket the base is part of the fixed one
/// @returns no cells where the recording is too short or still
PartCells collectCells(const Recording& recording, const MountModel& model, Part part);

}  // namespace wems::identify
