/// @file
/// Step size of the forward model from the fastest motion that the model can make.
#pragma once

#include <stdexcept>
#include <string>

#include "models/mount_model.hpp"

namespace wems::identify {

// Why there is no simulated motion.

/// The motion grew beyond all bounds, or holds what is too fast to be followed; the message tells when, or how fast.
class SimulationDiverged : public std::runtime_error {
public:
    /// @param time s, at which the motion grew
    explicit SimulationDiverged(double time)
        : SimulationDiverged("the simulated motion grew beyond all bounds at " + std::to_string(time) + " s") {}
    explicit SimulationDiverged(const std::string& what) : std::runtime_error(what) {}
};

/// Bounds on the rates of a model, from its equations linearised about the rest position.
struct FastestRates {
    double frequency = 0;  ///< rad/s, highest natural frequency with every stop closed (the stiffer side of each axis)
    double damping = 0;  ///< 1/s, highest rate of pure damping (dashpots, friction near zero velocity, Maxwell states)
};
FastestRates calcFastestRates(const MountModel& model);

/// Steps of classical Runge–Kutta for each sample interval (s), at least one: at most 0.8 over the highest frequency
/// and 1.5 over the highest damping rate (the method is stable up to 2.78).
///
/// Of fourth order with stops as without (identify/forward/stepper.hpp). Largest error over the largest displacement
/// against 64 or 128 steps per sample, two and a half seconds of a sweep whose stops are reached (single axis: 40 s
/// through its resonance):
///
///     step       cross, 30 m/s²    with bracket, 300 N    single axis, 1 m/s²
///     1 ms       1.1e-2            6.4e-2                 4.8e-1
///     0.5 ms     4.1e-4            3.3e-3                 1.7e-2
///     0.33 ms    9.5e-5            5.4e-4                 2.5e-3
///     0.25 ms    2.5e-5            1.6e-4                 6.6e-4
///     0.125 ms   9.8e-7            9.6e-6                 3.4e-5
///
/// This choice gives 0.4 to 0.6 ms there. What the motion itself amplifies decides, not the contact alone.
/// @throws SimulationDiverged where that would be more than a thousand steps: no recording tells such a law from a
/// rigid connection, and a simulation of a second would take minutes
int chooseStepsPerSample(const MountModel& model, double interval);

}  // namespace wems::identify
