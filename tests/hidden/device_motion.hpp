/// @file
/// Free motion of a hidden device: rigid body, connections, bracket or table, and an outside effect, integrated by an
/// integrator of its own, so that what the diagnosis simulates with is not what it is judged by.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <stdexcept>

#include "tests/hidden/outside_effect.hpp"
#include "tests/hidden/run_plan.hpp"
#include "tests/hidden/set_up.hpp"

namespace wems::hidden {

/// What acts from outside, at a rate of its own (Hz): a load (N) on bracket or mobile part, or the acceleration of the
/// table (m/s²).
struct Drive {
    double rate = kTableRate;
    Eigen::Matrix3Xd values;
    Eigen::VectorXd frequency;  ///< Hz, swept; empty where there is none
};
Drive makeDrive(const RunPlan& plan);

/// Points of both parts whose motion is wanted, each in its own frame.
struct Points {
    Eigen::Matrix3Xd mobile_displacement, mobile_acceleration, fixed_displacement, fixed_acceleration;
};

/// One column for each sample, row 3 i + axis. Motions are absolute, but for that of the table itself, which the caller
/// adds: relative to it.
struct DeviceMotion {
    Eigen::MatrixXd relative;  ///< of each connection, F axes, m
    Eigen::MatrixXd mobile_displacement, mobile_acceleration, fixed_displacement,
        fixed_acceleration;  ///< of the points
};

/// Nothing that can be measured moves like this: a device or an outside effect of no use.
class TruthDiverged : public std::runtime_error {
public:
    TruthDiverged() : std::runtime_error("the truth of a hidden case diverged") {}
};

/// A device that is simulated again and again.
struct HiddenDevice {
    const MountModel& model;
    const OutsideEffect& outside;
    const SetUp& set_up;
};

/// Classical Runge–Kutta; a force of the outside effect acts between both parts (a disturbance on the mobile part
/// alone).
/// @param rate Hz, of the samples
/// @param longest_step s; shorter where the model needs it
/// @param points null: relative displacements alone
/// @throws TruthDiverged
DeviceMotion simulateDevice(const HiddenDevice& device, const Drive& drive, double rate, Eigen::Index samples,
                            double longest_step, const Points* points = nullptr);

}  // namespace wems::hidden
