#include "plugin/simulation.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/common/error.hpp"
#include "models/mount_forces.hpp"

namespace wems::plugin {
namespace {

void checkSettings(const MountModel& model, const Drive& drive, const SimulationSettings& settings) {
    if (settings.times.empty()) throw InputError({}, "the run has no sample", "a duration above the sample interval");
    if (!(settings.accuracy > 0 && settings.accuracy < 1))
        throw InputError({"", 0, "accuracy"}, "is out of range", "a number between 0 and 1, such as 1e-6");
    if (drive.hasLoad() && model.load && dependsOnFrequency(*model.load) && std::isnan(drive.calcFrequency(0)))
        throw InputError({"", 0, "load.gain_over_frequency"}, "the excitation has no swept frequency",
                         "a sweep, a dwell, or a single `gain`");
}

/// Where the motion was when the integrator gave up.
std::string describeFailure(const Device& device, const SimTK::State& state, const std::string& simbody_message) {
    double largest = 0;
    if (state.getSystemStage() >= SimTK::Stage::Velocity) {
        const BodyMotion mobile = calcFrameMotion(device.body(), SimTK::Transform(), state);
        const FrameMotion fixed = device.force().calcFixedMotion(state);
        for (const Connection& connection : device.model().connections)
            largest = std::max(largest, calcRelativeMotion(mobile, fixed, connection.position).q.cwiseAbs().maxCoeff());
    }
    char text[160];
    std::snprintf(text, sizeof text,
                  "the integration broke off at t = %.6g s, relative displacement %.3g m: ", state.getTime(), largest);
    return text + (device.force().failure().empty() ? simbody_message : device.force().failure());
}

/// Adds noise to blocks of rows and hands them on, or keeps them.
class RowSink {
public:
    RowSink(const std::vector<SensorChannel>& channels, const SimulationSettings& settings)
        : settings_(settings), kept_(makeRecordingHeader(channels)) {
        for (const SensorChannel& channel : channels) noise_.emplace_back(settings.noise, settings.seed, channel.name);
    }

    void take(const std::vector<double>& times, std::vector<std::vector<double>> values) {
        samples_ += times.size();
        for (std::size_t i = 0; i < values.size(); ++i) noise_[i].add(values[i]);
        if (settings_.sink) {
            Recording rows = kept_;
            rows.time = times;
            for (std::size_t i = 0; i < values.size(); ++i) rows.channels[i].values = std::move(values[i]);
            settings_.sink(rows);
            return;
        }
        kept_.time.insert(kept_.time.end(), times.begin(), times.end());
        for (std::size_t i = 0; i < values.size(); ++i) {
            std::vector<double>& kept = kept_.channels[i].values;
            kept.insert(kept.end(), values[i].begin(), values[i].end());
        }
    }

    std::size_t samples() const { return samples_; }
    Recording release() { return std::move(kept_); }

private:
    const SimulationSettings& settings_;
    Recording kept_;
    std::vector<ChannelNoise> noise_;
    std::size_t samples_ = 0;
};

}  // namespace

Recording makeRecordingHeader(const std::vector<SensorChannel>& channels) {
    Recording recording;
    for (const SensorChannel& sensor : channels) {
        const ChannelName& name = sensor.name;
        Channel channel;
        channel.name = formatChannelName(name);
        channel.unit = name.part == Part::load                       ? "N"
                       : name.derivative == Derivative::displacement ? "m"
                       : name.derivative == Derivative::velocity     ? "m/s"
                                                                     : "m/s^2";
        channel.column = static_cast<int>(recording.channels.size()) + 2;
        recording.channels.push_back(std::move(channel));
    }
    return recording;
}

SimulationResult simulate(const MountModel& model, std::shared_ptr<const Drive> drive,
                          const SimulationSettings& settings) {
    checkSettings(model, *drive, settings);
    const bool has_load = drive->hasLoad(), has_base = drive->hasBase();
    Device device(model, std::move(drive), settings.times.back());
    std::string stopped;
    if (settings.watch) device.force().setWatch([&](double t) { return stopped = settings.watch(t); });
    const std::vector<SensorChannel> channels = makeSensorChannels(model, settings.channels, has_load, has_base);
    RowSink sink(channels, settings);
    Recorder recorder(device, channels, settings.times,
                      [&sink](const std::vector<double>& times, auto values) { sink.take(times, std::move(values)); });
    recorder.setProgress(settings.progress);
    recorder.setObserver(settings.observer);
    device.updSystem().addEventReporter(recorder.makeReporter());
    const SimTK::State start = device.makeRestState();

    SimTK::RungeKuttaMersonIntegrator integrator(device.system());
    integrator.setAccuracy(settings.accuracy);
    integrator.setMaximumStepSize(settings.longest_step);
    SimTK::TimeStepper stepper(device.system(), integrator);
    const auto clock_start = std::chrono::steady_clock::now();
    stepper.initialize(start);
    const auto breakOff = [&](const std::string& reason) {
        if (!stopped.empty()) throw InputError({}, stopped);
        throw InputError({}, describeFailure(device, integrator.getState(), reason));
    };
    try {
        stepper.stepTo(recorder.endTime());
    } catch (const SimTK::Exception::Base& error) {
        breakOff(error.getMessageText());
    } catch (const DeviceFailure& error) {
        breakOff(error.what());
    }
    if (!recorder.complete()) recorder.takeSample(integrator.getState());
    if (!recorder.complete()) throw std::logic_error("the simulation ended before its last sample");

    SimulationResult result;
    result.recording = sink.release();
    result.samples = sink.samples();
    result.contacts = recorder.contacts();
    result.largest = recorder.largest();
    result.cost.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock_start).count();
    result.cost.steps = integrator.getNumStepsTaken();
    result.cost.attempted_steps = integrator.getNumStepsAttempted();
    result.cost.realizations = integrator.getNumRealizations();
    return result;
}

}  // namespace wems::plugin
