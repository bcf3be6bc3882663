/// @file
/// One run of the device: integrate, record, summarise.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "plugin/drive.hpp"
#include "plugin/recorder.hpp"

namespace wems::plugin {

struct SimulationSettings {
    SampleTimes times;  ///< s, increasing, from 0 on: the rows of the recording
    ChannelSelection channels;
    SensorNoise noise;
    std::uint64_t seed = 1;
    /// Of the Runge–Kutta–Merson integrator, an absolute error in m, m/s and rad for each step.
    double accuracy = 1e-6;
    /// s. Reports are cubic interpolations between steps, in error by (ω h)⁴/384.
    double longest_step = 1e-3;
    std::function<void(double)> progress;                       ///< called with the time of each sample, s
    std::function<void(double, const DeviceMotion&)> observer;  ///< called at each sample with its time, s
    /// Called now and then with the time that the integrator has reached, s. What it returns, unless empty, ends the
    /// run as the reason of an InputError.
    std::function<std::string(double)> watch;
    /// Receives the recording in blocks while the run goes on; absent: it is kept in the result.
    std::function<void(const Recording& rows)> sink;
};

/// What it cost.
struct SimulationCost {
    double wall_time = 0;  ///< s
    int steps = 0;
    int attempted_steps = 0;
    int realizations = 0;  ///< of the equations of motion, by the integrator
};

struct SimulationResult {
    Recording recording;      ///< SI; without file and metadata, and without samples if a sink took them
    std::size_t samples = 0;  ///< that were recorded
    std::vector<StopContact> contacts;
    std::vector<LargestDisplacement> largest;
    SimulationCost cost;
};

/// Names and units of the channels that such a run records.
Recording makeRecordingHeader(const std::vector<SensorChannel>& channels);

/// Simulates `model` under `drive` from its static equilibrium.
/// @throws InputError if the model or the settings cannot be used, with the time and the reason if the integration
/// breaks off.
SimulationResult simulate(const MountModel& model, std::shared_ptr<const Drive> drive,
                          const SimulationSettings& settings);

}  // namespace wems::plugin
