/// @file
/// What drives a simulation: the force at the bracket's load point and the acceleration of the base, as pure functions
/// of time, so that trial steps, rejected steps and any output rate see the same excitation.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/excitation.hpp"
#include "models/recording/recording.hpp"

namespace wems::plugin {

// Natural cubic spline through samples: a twice continuously differentiable function of time.

/// Interpolates y over x (strictly increasing, at least one sample); second derivative zero at the ends, constant
/// outside. With samples h apart and angular frequency ω the relative error is about (ωh)⁴/384 away from the ends.
/// Source: de Boor, A Practical Guide to Splines (1978), ch. IV.
class CubicSpline {
public:
    CubicSpline(std::vector<double> x, std::vector<double> y);
    double calcValue(double x) const;

private:
    std::vector<double> x_, y_, curvature_;
};

class Drive {
public:
    virtual ~Drive() = default;
    virtual double duration() const = 0;                               ///< s
    virtual Eigen::Vector3d calcLoad(double t) const = 0;              ///< N, ground axes, as commanded or recorded
    virtual Eigen::Vector3d calcBaseAcceleration(double t) const = 0;  ///< m/s², ground axes
    virtual double calcFrequency(double t) const = 0;                  ///< swept frequency, Hz; NaN if nothing sweeps
    /// Hz, the fastest that load and base hold.
    virtual double highestFrequency() const = 0;
    /// Times (s) at which they have a kink.
    virtual std::vector<double> kinks() const { return {}; }
    /// Displacement (m) and velocity (m/s) with which a base starts that does not drift; none: not known.
    struct BaseStart {
        Eigen::Vector3d displacement, velocity;
    };
    virtual std::optional<BaseStart> findBaseStart() const { return std::nullopt; }
    virtual bool hasLoad() const = 0;
    virtual bool hasBase() const = 0;
};

/// `signal` times a constant force (N) and a constant base acceleration (m/s²).
/// @param swept false if the signal's frequency() is not the frequency of what it contains (random)
std::shared_ptr<const Drive> makeSignalDrive(std::shared_ptr<const Signal> signal, const Eigen::Vector3d& force,
                                             const Eigen::Vector3d& base_acceleration, bool swept);

/// The load and base acceleration of a recording; its first sample is t = 0. Between samples cubic splines; constant
/// beyond the ends. The swept frequency comes from the zero crossings of the strongest channel.
/// @throws InputError if there is neither load nor base motion in the recording.
std::shared_ptr<const Drive> makeReplayDrive(const Recording& recording);

}  // namespace wems::plugin
