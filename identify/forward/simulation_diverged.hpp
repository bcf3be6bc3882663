/// @file
/// Why there is no simulated motion.
#pragma once

#include <stdexcept>
#include <string>

namespace wems::identify {

/// The motion grew beyond all bounds, or holds what is too fast to be followed; the message tells when, or how fast.
class SimulationDiverged : public std::runtime_error {
public:
    /// @param time s, at which the motion grew
    explicit SimulationDiverged(double time)
        : SimulationDiverged("the simulated motion grew beyond all bounds at " + std::to_string(time) + " s") {}
    explicit SimulationDiverged(const std::string& what) : std::runtime_error(what) {}
};

}  // namespace wems::identify
