#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::updating {

/// A rigid motion that sweeps from 5 to 50 Hz in all six directions, each with an amplitude and a phase of its own.
class SweptMotion {
public:
    explicit SweptMotion(std::mt19937_64& random) {
        std::uniform_real_distribution<double> amplitude(0.3, 1), phase(0, kTwoPi);
        for (int i = 0; i < 6; ++i) {
            amplitude_[i] = amplitude(random) * (i < 3 ? 1e-3 : 1e-2);
            phase_[i] = phase(random);
        }
    }
    static constexpr double kDuration = 8;

    /// Of the point r.
    Eigen::Vector3d findPoint(double t, const Eigen::Vector3d& r) const {
        return at(t, 0) + rotationFromVector(at(t, 3)) * r;
    }

    /// By differences of fourth order: 1e-8 of the acceleration at 50 Hz.
    Eigen::Vector3d findAcceleration(double t, const Eigen::Vector3d& r) const {
        constexpr double h = 1e-4;
        return (-findPoint(t - 2 * h, r) / 12 + 4 * findPoint(t - h, r) / 3 - 5 * findPoint(t, r) / 2 +
                4 * findPoint(t + h, r) / 3 - findPoint(t + 2 * h, r) / 12) /
               (h * h);
    }

private:
    Eigen::Vector3d at(double t, int first) const {
        const double octaves = std::log(10.0) / kDuration;
        const double angle = kTwoPi * 5 * (std::exp(octaves * t) - 1) / octaves;
        // From rest to rest; the motion of a device that is driven by forces falls with frequency. Two seconds of rise:
        // what a faster one has below 5 Hz is lost from the recovered rotation, and 1 % of it leaves twice the noise,
        // which bends the misfit too.
        const double edge = std::min({1.0, 0.5 * std::max(0.0, t), 0.5 * std::max(0.0, kDuration - t)});
        const double size = std::exp(-octaves * t) * std::pow(std::sin(0.25 * kTwoPi * edge), 4);
        Eigen::Vector3d value;
        for (int a = 0; a < 3; ++a) value[a] = size * amplitude_[first + a] * std::sin(angle + phase_[first + a]);
        return value;
    }
    double amplitude_[6], phase_[6];
};

/// At 1 kHz, along the given axes of each station of the mobile part, noise on each channel.
/// @param kind "" of displacements, "a" of accelerations; @param read of a station at a time (s)
inline Recording recordStations(const std::vector<std::pair<std::string, std::string>>& stations_and_axes,
                                const std::string& kind,
                                const std::function<Eigen::Vector3d(std::size_t station, double time)>& read,
                                double noise, std::mt19937_64& random) {
    std::normal_distribution<double> normal(0, noise);
    Recording recording;
    for (double t = 0; t < SweptMotion::kDuration; t += 1e-3) recording.time.push_back(t);
    for (std::size_t i = 0; i < stations_and_axes.size(); ++i)
        for (const char axis : stations_and_axes[i].second) {
            Channel channel;
            channel.name = "mobile." + stations_and_axes[i].first + "." + kind + axis;
            channel.unit = kind.empty() ? "m" : "m/s^2";
            for (const double t : recording.time) channel.values.push_back(read(i, t)[axis - 'x'] + normal(random));
            recording.channels.push_back(std::move(channel));
        }
    return recording;
}

}  // namespace wems::identify::updating
