/// @file
/// Velocity and displacement of the base from its acceleration.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plugin/drive.hpp"

namespace wems::plugin {

/// Integrates the base acceleration of a drive. The device feels the acceleration alone, so that the base's starting
/// velocity and position are free; they are chosen such that over the run the displacement has neither mean nor
/// straight-line drift (least squares). The device starts at rest relative to the base.
class BaseMotion {
public:
    /// @param duration s, of the run
    BaseMotion(const Drive& drive, double duration);

    struct Value {
        Eigen::Vector3d displacement, velocity;  ///< m, m/s
    };
    /// At t within [0, duration]; beyond, the nearest end.
    Value calcValue(double t) const;

private:
    Value integrate(const Value& from, double t0, double t1) const;

    const Drive& drive_;
    double step_ = 0;
    std::vector<Value> nodes_;  // at k step_
};

}  // namespace wems::plugin
