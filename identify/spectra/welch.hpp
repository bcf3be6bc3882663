/// @file
/// Spectral densities of several signals and their cross densities with one of them, by Welch's method.
#pragma once

#include <Eigen/Core>

namespace wems::identify {

/// Segments with a periodic Hann window, each freed from its mean, half overlapping.
struct WelchSettings {
    Eigen::Index segment = 1024;  ///< samples
};

struct CrossSpectra {
    Eigen::VectorXd frequency;  ///< Hz, from 0 to half the sampling rate
    Eigen::MatrixXd density;    ///< bins x signals, one-sided, unit²/Hz
    Eigen::MatrixXcd cross;     ///< bins x signals: mean of conj(R) Y, R the reference; one-sided
    Eigen::Index reference = 0;
    Eigen::Index segments = 0;
    /// Of each density: 2 K for K independent segments, less by what neighbours share. Source: Welch (1967),
    /// doi:10.1109/TAU.1967.1161901.
    double degrees_of_freedom = 0;
    double resolution = 0;  ///< Hz, from one bin to the next
};

/// The definitions of SciPy's `welch`, `csd` and `coherence` with their defaults but for the segment.
/// @param signals one column each @param reference column that the others are crossed with
/// @param interval s between samples
/// @throws InputError if the segment is longer than the signals or shorter than 8 samples
CrossSpectra estimateSpectra(const Eigen::MatrixXd& signals, Eigen::Index reference, double interval,
                             const WelchSettings& settings);

/// The power of two that gives at least `averages` half-overlapping segments, at least 8 samples.
Eigen::Index chooseSegment(Eigen::Index samples, int averages);

}  // namespace wems::identify
