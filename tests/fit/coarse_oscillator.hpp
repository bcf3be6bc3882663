/// @file
/// A one-axis device with a measured load, sampled with few samples in a period: integrated by a Runge–Kutta scheme of
/// its own, on a load that is known at all times.
#pragma once

#include <cstdint>
#include <random>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::test {

/// m x'' + d x' + k x + c x³ = u(t); sensors read x + zero and u + zero.
struct CoarseOscillator {
    double mass = 0, damping = 0, stiffness = 0, cubic = 0;  // SI
    double displacement_zero = 0, load_zero = 0;             // m, N
    double samples_a_period = 0;                             // of its small motions
    double rms = 0;                                          // m, of its motion, about

    double interval() const;  ///< s
    /// With those numbers, and sensors' zeros.
    MountModel makeModel() const;
};

/// Mass over three decades, damping ratio 2 to 8 %, hardening by 5 to 30 % at the RMS, zeros up to a tenth of the
/// motion.
CoarseOscillator drawOscillator(std::mt19937_64& random);

/// A multisine up to a third of the sampling rate; from rest, or from the midst of motion.
/// @param noise of the displacement, over its RMS
Recording recordOscillator(const CoarseOscillator& device, int samples, bool from_rest, double noise,
                           std::uint64_t seed);

/// `model` with stiffness, damping and cubic off by up to a factor, and without zeros.
MountModel mistake(MountModel model, double factor, std::mt19937_64& random);

}  // namespace wems::test
