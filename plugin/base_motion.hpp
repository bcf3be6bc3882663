/// @file
/// Velocity and displacement of the base from its acceleration.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plugin/drive.hpp"

namespace wems::plugin {

/// Integrates the base acceleration of a drive. The device feels the acceleration alone, so that the base's starting
/// velocity and position are free: those of a sum of sines without drift where the drive knows them; otherwise such
/// that over the run the displacement has neither mean nor straight-line drift (least squares). The device starts at
/// rest relative to the base.
///
/// Steps are at most 1/16 of the fastest period and end at kinks; three-point Gauss then errs by 2e-9 of a sine's
/// displacement, at any frequency of the drive.
class BaseMotion {
public:
    /// @param duration s, of the run
    BaseMotion(const Drive& drive, double duration);

    /// s, from one node to the next
    static double findLongestStep(const Drive& drive);

    struct Value {
        Eigen::Vector3d displacement, velocity;  ///< m, m/s
    };
    /// At t within [0, duration]; beyond, the nearest end.
    Value calcValue(double t) const;

private:
    void removeDrift();
    Value integrate(const Value& from, double t0, double t1) const;

    const Drive& drive_;
    std::vector<double> times_;  // of the nodes, from 0 on
    std::vector<Value> nodes_;
};

}  // namespace wems::plugin
