/// @file
/// Sampling a running simulation into the channels of a recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "models/sensor_reading.hpp"
#include "plugin/device.hpp"

namespace wems::plugin {

// The times of a recording's rows.

/// Increasing times, s: listed one by one, or k/rate, which takes no memory.
class SampleTimes {
public:
    SampleTimes() = default;
    SampleTimes(std::vector<double> times) : listed_(std::move(times)) {}  // NOLINT: a list is such times
    static SampleTimes makeUniform(double rate, std::size_t count) {
        SampleTimes times;
        times.rate_ = rate;
        times.count_ = count;
        return times;
    }

    void push_back(double time) { listed_.push_back(time); }
    std::size_t size() const { return listed_.size() + count_; }
    bool empty() const { return size() == 0; }
    double operator[](std::size_t k) const { return count_ > 0 ? static_cast<double>(k) / rate_ : listed_[k]; }
    double back() const { return (*this)[size() - 1]; }

private:
    std::vector<double> listed_;
    double rate_ = 1;
    std::size_t count_ = 0;  // of uniform times; none are listed then
};

// Noise of the sensors on a simulated recording.

/// RMS of independent Gaussian noise on each sample; zero = none.
struct SensorNoise {
    double displacement = 0;  ///< m
    double velocity = 0;      ///< m/s
    double acceleration = 0;  ///< m/s², of both ends of the connections
    double load = 0;          ///< N
    double base = 0;          ///< m/s², of the recorded base acceleration
};

/// RMS of the noise on a channel of this name.
double getNoiseLevel(const SensorNoise& noise, const ChannelName& name);

/// The noise of one channel, block after block. The sequence depends on the seed and the channel's name alone, so that
/// a channel's noise is the same whatever else is recorded.
class ChannelNoise {
public:
    ChannelNoise(const SensorNoise& noise, std::uint64_t seed, const ChannelName& name);
    /// Adds it to the next values.
    void add(std::vector<double>& values);

private:
    bool present_;
    std::mt19937_64 generator_;
    std::normal_distribution<double> normal_;
};

/// Which quantities of both ends of the connections become channels. Load and base motion do whenever they are there.
struct ChannelSelection {
    bool displacement = true, velocity = false, acceleration = true;
};

/// A channel and what the model's sensor faults make of it: measured(t) = gain · [rotation · true(t − delay)]_axis +
/// zero.
struct SensorChannel {
    ChannelName name;
    SensorReading reading;
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
