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
#include "plugin/sample_times.hpp"

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
        long visits = 0;  ///< times that it was reached: with samples in which it was not touched between them
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

/// What a run leaves: filled by the reporter that makeReporter() returns. Rows that are complete are handed on in
/// blocks, so that memory does not grow with the run.
class Recorder {
public:
    using RowTaker = std::function<void(std::vector<double> times, std::vector<std::vector<double>> values)>;
    static constexpr std::size_t block_rows = 4096;

    /// @param times s, increasing, from 0: the rows of the recording
    /// @param take receives blocks of complete rows in their order: times, and for each channel its values
    Recorder(const Device& device, std::vector<SensorChannel> channels, SampleTimes times, RowTaker take);

    /// The simulation must reach this time, s: the last row, later if a sensor leads.
    double endTime() const;

    /// To be given to Device::updSystem().addEventReporter(), which takes it over; this Recorder must outlive it. A
    /// delayed sensor is sampled at exactly t − delay, through the integrator's own interpolation; before the start it
    /// sees the first instant. Reports never change the integrator's steps.
    SimTK::ScheduledEventReporter* makeReporter();

    /// Called at each sample with its time, s.
    void setProgress(std::function<void(double)> progress) { progress_ = std::move(progress); }

    /// Called at each sample with its time, s, and the motion that sensors without delay could see.
    void setObserver(std::function<void(double, const DeviceMotion&)> observer) { observer_ = std::move(observer); }

    /// Takes one report at the state's time; the reporter calls it.
    void takeSample(const SimTK::State& state);
    double findNextTime(double time, bool include_current) const;

    /// True once every row is filled.
    bool complete() const { return taken_ == times_.size(); }

    const std::vector<SensorChannel>& channels() const { return channels_; }
    const std::vector<StopContact>& contacts() const { return contacts_; }        ///< one for each stop of the model
    const std::vector<LargestDisplacement>& largest() const { return largest_; }  ///< one for each connection and axis

private:
    /// Where the sensors of one delay stand.
    struct Cursor {
        double delay = 0;     // s
        std::size_t row = 0;  // the next one
    };
    /// When a cursor's next row is sampled; infinite at the end.
    double findTime(const Cursor& cursor) const;
    const Cursor& findNext() const;
    void handOn(std::size_t rows);
    void watchStops(const DeviceMotion& motion, double time);

    const Device& device_;
    std::vector<SensorChannel> channels_;
    std::vector<std::size_t> delay_of_channel_, connection_of_channel_;
    SampleTimes times_;
    RowTaker take_;
    std::vector<Cursor> cursors_;              // by delay
    std::size_t undelayed_ = 0;                // the cursor without delay
    std::size_t taken_ = 0;                    // rows that were handed on
    std::vector<std::vector<double>> values_;  // of the rows from taken_ on
    std::vector<StopContact> contacts_;
    std::vector<LargestDisplacement> largest_;
    double watched_ = -1;  // s, of the sample before
    std::function<void(double)> progress_;
    std::function<void(double, const DeviceMotion&)> observer_;
};

}  // namespace wems::plugin
