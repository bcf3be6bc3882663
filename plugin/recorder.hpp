/// @file
/// Sampling a running simulation into the channels of a recording.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "plugin/device.hpp"

namespace wems::plugin {

/// Which quantities of both ends of the connections become channels. Load and base motion do whenever they are there.
struct ChannelSelection {
    bool displacement = true, velocity = false, acceleration = true;
};

/// A channel and what the model's sensor faults make of it: measured(t) = gain · [rotation · true(t − delay)]_axis.
struct SensorChannel {
    ChannelName name;
    double gain = 1;
    double delay = 0;  ///< s
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
};
std::vector<SensorChannel> makeSensorChannels(const MountModel& model, const ChannelSelection& selection, bool has_load,
                                              bool has_base);

/// When and how deep a stop was touched, seen at the samples.
struct StopContact {
    int connection = 0, axis = 0;
    std::size_t stop = 0;  ///< index in the axis law
    /// Times between which the stop is touched again and again, with pauses of at most longest_pause.
    struct Interval {
        double first = 0, last = 0;  ///< s
        double deepest = 0;          ///< m, largest penetration at a sample
        long samples = 0;
    };
    static constexpr double longest_pause = 0.5;  ///< s
    std::vector<Interval> intervals;              ///< empty: never touched
};

/// Largest relative displacement at a sample.
struct LargestDisplacement {
    int connection = 0, axis = 0;
    double value = 0;  ///< m, signed
    double time = 0;   ///< s
};

/// What a run leaves: filled by the reporter that makeReporter() returns.
class Recorder {
public:
    /// @param times s, increasing, from 0: the rows of the recording
    Recorder(const Device& device, std::vector<SensorChannel> channels, std::vector<double> times);

    /// The simulation must reach this time, s: the last row, later if a sensor leads.
    double endTime() const;

    /// To be given to Device::updSystem().addEventReporter(), which takes it over; this Recorder must outlive it. A
    /// delayed sensor is sampled at exactly t − delay, through the integrator's own interpolation; before the start it
    /// sees the first instant. Reports never change the integrator's steps.
    SimTK::ScheduledEventReporter* makeReporter();

    /// Called at each sample with its time, s.
    void setProgress(std::function<void(double)> progress) { progress_ = std::move(progress); }

    /// Takes one report at the state's time; the reporter calls it.
    void takeSample(const SimTK::State& state);
    double findNextTime(double time, bool include_current) const;

    /// True once every row is filled.
    bool complete() const { return next_ == events_.size(); }

    const std::vector<SensorChannel>& channels() const { return channels_; }
    const std::vector<std::vector<double>>& values() const { return values_; }    ///< one vector for each channel
    const std::vector<StopContact>& contacts() const { return contacts_; }        ///< one for each stop of the model
    const std::vector<LargestDisplacement>& largest() const { return largest_; }  ///< one for each connection and axis

private:
    struct Event {
        double time;
        std::size_t row, delay;
    };
    void watchStops(const DeviceMotion& motion, double time);

    const Device& device_;
    std::vector<SensorChannel> channels_;
    std::vector<std::size_t> delay_of_channel_, connection_of_channel_;
    std::size_t undelayed_ = 0;
    std::vector<Event> events_;
    std::size_t next_ = 0;
    std::vector<std::vector<double>> values_;
    std::vector<StopContact> contacts_;
    std::vector<LargestDisplacement> largest_;
    std::function<void(double)> progress_;
};

}  // namespace wems::plugin
