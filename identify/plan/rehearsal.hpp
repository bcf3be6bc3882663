/// @file
/// A further run as it would be, if the device is what a fit says: the fast forward model, driven by the candidate's
/// sweep, measured by the channels of the runs before with their noise.
#pragma once

#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "identify/plan/test_setup.hpp"

namespace wems::identify {

/// Largest motions of a simulated run.
struct RunExtent {
    double stroke = 0;             ///< m, relative displacement
    std::string stroke_at;         ///< `4.z`
    double base_displacement = 0;  ///< m, amplitude
    std::vector<double> hertz;     ///< middle of each of some windows along the sweep
    std::vector<double> strokes;   ///< m, largest of all connections and axes within each
};

class Rehearsal {
public:
    /// @param device model that the run is simulated with
    Rehearsal(const TestSetup& setup, const MountModel& device);

    /// Without noise and channels; cheap beside record(). @throws SimulationDiverged
    RunExtent calcExtent(const PlannedRun& candidate) const;

    /// The candidate as a recording, noise included. Kinds of sensors that the setup lacks stand beside those that it
    /// has, with the noise of kAddedNoise. @throws SimulationDiverged
    Recording record(const PlannedRun& candidate) const;
    /// The motion that is estimated from it, as from a recording.
    RunMotion measure(const PlannedRun& candidate) const;

    /// Of sensors that were not there yet: 1 µm and 0.01 m/s² RMS, usual for lasers and piezoelectric sensors.
    static constexpr double kAddedDisplacementNoise = 1e-6, kAddedAccelerationNoise = 0.01;

private:
    RunMotion makeDrivenRun(const PlannedRun& candidate) const;
    void keepChannels(const PlannedRun& candidate, Recording& recording) const;

    const TestSetup& setup_;
    MountModel device_;  // without sensors elsewhere and their faults, which the recorded motions are free of
};

}  // namespace wems::identify
