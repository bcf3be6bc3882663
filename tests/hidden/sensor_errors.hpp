/// @file
/// What sensors make of the truth: gain, direction and place of each, noise, AC coupling, the filter before sampling.
#pragma once

#include <Eigen/Core>

#include "tests/hidden/random_numbers.hpp"
#include "tests/hidden/small_errors.hpp"

namespace wems::hidden {

/// Three channels at a place, one column for each triax.
struct TriaxErrors {
    Eigen::Matrix3Xd gain;      ///< -
    Eigen::Matrix3Xd rotation;  ///< rotation vectors, rad
    Eigen::Matrix3Xd place;     ///< m, of the sensor minus where it is believed to be
};

struct SensorErrors {
    TriaxErrors mobile_displacement, mobile_acceleration, fixed_displacement, fixed_acceleration, base;
    Eigen::Vector3d load_gain = Eigen::Vector3d::Ones();  ///< recorded over applied
    double load_noise = 0;                                ///< of the load's RMS
    bool filtered = false;     ///< Butterworth, fourth order, 0.4 of the sampling rate, in all channels alike
    double pink = 0;           ///< RMS of the 1/f part over that of the white one
    double hum = 0;            ///< RMS over that of the white noise
    double hum_frequency = 0;  ///< Hz, of the mains
    double coupling = 0;       ///< Hz, corner of the accelerometers' AC coupling, first order; 0: none
};

/// Levels 0, 1 and 2. @param count connections; @param time_scale mains and coupling do not slow down with the device;
/// the coupling's corner is at 0.3 Hz, or, for a slower device, where it is in unit time
SensorErrors drawSensorErrors(int level, std::size_t count, double time_scale, Random& random);

/// Second-order sections of a Butterworth low-pass of fourth order, bilinear with the corner met exactly.
class AntiAliasFilter {
public:
    /// @param corner over the rate of the samples
    explicit AntiAliasFilter(double corner);
    /// From rest.
    void apply(Eigen::Ref<Eigen::VectorXd> signal) const;

private:
    struct Section {
        double b0, a1, a2;
    } sections_[2];
};

/// High-pass of first order, from rest. @param corner over the rate of the samples
void coupleAc(Eigen::Ref<Eigen::VectorXd> signal, double corner);

/// White noise with a 1/f part and hum, for a white part of unit RMS below 0.4 of the sampling rate. @param finer
/// samples for each that is recorded; @param rate Hz; @param time_scale of the device, since the mains have their own
/// time
Eigen::VectorXd drawNoise(const SensorErrors& errors, int finer, double time_scale, double rate, Eigen::Index samples,
                          Random& random);

}  // namespace wems::hidden
