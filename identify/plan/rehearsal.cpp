#include "identify/plan/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "identify/forward/forward_model.hpp"
#include "identify/forward/simulated_recording.hpp"
#include "models/common/format_number.hpp"
#include "models/excitation.hpp"

namespace wems::identify {
namespace {

constexpr Eigen::Index kWindows = 160;  // of the extent
constexpr unsigned kBaseNoiseSeed = 2;

/// Displacement of a base whose acceleration is the signal: integrated by three-point Gauss within each sample, without
/// mean and straight-line drift, as `simulate` has it (the device feels the acceleration alone).
Eigen::VectorXd integrateBase(const Signal& signal, const std::vector<double>& time, double interval) {
    const auto count = static_cast<Eigen::Index>(time.size());
    const double offset = std::sqrt(0.6) / 2;
    const std::array<double, 3> node{0.5 - offset, 0.5, 0.5 + offset}, weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
    Eigen::VectorXd displacement = Eigen::VectorXd::Zero(count);
    double velocity = 0;
    for (Eigen::Index k = 0; k + 1 < count; ++k) {
        double next_velocity = velocity;
        displacement[k + 1] = displacement[k] + interval * velocity;
        for (std::size_t i = 0; i < 3; ++i) {
            const double a = signal.value(time[k] + node[i] * interval);
            next_velocity += weight[i] * interval * a;
            displacement[k + 1] += weight[i] * interval * interval * (1 - node[i]) * a;
        }
        velocity = next_velocity;
    }
    const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(count, -1, 1);
    const double slope = s.dot(displacement) / s.squaredNorm();
    const double mean = displacement.mean();
    return displacement - slope * s - Eigen::VectorXd::Constant(count, mean);
}

/// A kind of sensor on a part where the other kind is.
void addKinds(const SensorKinds& wanted, PartMotion& part) {
    if (!part.displacement_measured && !part.acceleration_measured) return;
    if (wanted.displacement && !part.displacement_measured) {
        part.displacement_measured = true;
        part.displacement_noise = Rehearsal::kAddedDisplacementNoise;
    }
    if (wanted.acceleration && !part.acceleration_measured) {
        part.acceleration_measured = true;
        part.acceleration_noise = Rehearsal::kAddedAccelerationNoise;
    }
}

void setSensors(const SensorKinds& kinds, const ChannelNoise& noise, PartMotion& part) {
    part.displacement_measured = kinds.displacement;
    part.acceleration_measured = kinds.acceleration;
    part.displacement_noise = noise.displacement;
    part.acceleration_noise = noise.acceleration;
}

}  // namespace

Rehearsal::Rehearsal(const TestSetup& setup, const MountModel& device) : setup_(setup), device_(device) {
    device_.places.clear();
    device_.sensors.clear();
}

RunMotion Rehearsal::makeDrivenRun(const PlannedRun& candidate) const {
    const auto sweep = makeLogarithmicSweep(candidate.from, candidate.to, candidate.octaves_per_minute);
    RunMotion run;
    run.file = "next.csv";
    run.interval = 1 / candidate.sample_rate;
    const auto samples = static_cast<Eigen::Index>(std::floor(sweep->duration() * candidate.sample_rate)) + 1;
    Eigen::RowVectorXd value(samples);
    for (Eigen::Index k = 0; k < samples; ++k) {
        run.time.push_back(static_cast<double>(k) / candidate.sample_rate);
        value[k] = sweep->value(run.time.back());
    }
    const Eigen::Matrix3Xd level = candidate.level * value;
    if (candidate.excitation == Excitation::load) {
        run.load = level;
        run.fixed_source = FixedSource::still;  // but for what the load makes of a bracket
    } else {
        run.base = level;
        run.base_displacement = candidate.level * integrateBase(*sweep, run.time, run.interval).transpose();
        run.fixed_source = FixedSource::base;
    }
    setSensors(setup_.mobile, setup_.mobile_noise, run.mobile);
    setSensors(setup_.fixed, setup_.fixed_noise, run.fixed);
    for (PartMotion* part : {&run.mobile, &run.fixed}) addKinds(candidate.sensors, *part);
    return run;
}

RunExtent Rehearsal::calcExtent(const PlannedRun& candidate) const {
    const RunMotion run = makeDrivenRun(candidate);
    const ForwardModel forward(device_);
    const Eigen::MatrixXd q = forward.simulate(Drive::make(run, device_, makeGrid(run, device_))).q;
    RunExtent extent;
    Eigen::Index row = 0, column = 0;
    extent.stroke = q.cwiseAbs().maxCoeff(&row, &column);
    extent.stroke_at = device_.connections[row / 3].name + "." + kAxes[row % 3];
    if (run.base_displacement.cols() > 0) extent.base_displacement = run.base_displacement.colwise().norm().maxCoeff();
    const double octaves = std::log2(candidate.to / candidate.from);
    for (Eigen::Index window = 0; window < kWindows; ++window) {
        const Eigen::Index first = window * q.cols() / kWindows, end = (window + 1) * q.cols() / kWindows;
        if (end == first) continue;
        extent.hertz.push_back(candidate.from * std::exp2(octaves * (static_cast<double>(window) + 0.5) / kWindows));
        extent.strokes.push_back(q.middleCols(first, end - first).cwiseAbs().maxCoeff());
    }
    return extent;
}

void Rehearsal::keepChannels(const PlannedRun& candidate, Recording& recording) const {
    if (setup_.channels.empty()) return;
    const auto recorded = [&](const ChannelName& name) {
        return std::binary_search(setup_.channels.begin(), setup_.channels.end(), formatChannelName(name));
    };
    const SensorKinds known = setup_.kinds();
    const auto isThere = [&](const Channel& channel) {
        auto name = parseChannelName(channel.name);
        if (!name || (name->part != Part::mobile && name->part != Part::fixed)) return true;
        if (recorded(*name)) return true;
        const bool moves = name->derivative == Derivative::displacement;
        const bool added = moves ? candidate.sensors.displacement && !known.displacement
                                 : candidate.sensors.acceleration && !known.acceleration;
        name->derivative = moves ? Derivative::acceleration : Derivative::displacement;
        return added && recorded(*name);
    };
    auto& channels = recording.channels;
    channels.erase(std::remove_if(channels.begin(), channels.end(), [&](const Channel& c) { return !isThere(c); }),
                   channels.end());
}

Recording Rehearsal::record(const PlannedRun& candidate) const {
    Recording recording = simulateRecording(makeDrivenRun(candidate), device_, {1, setup_.gain_scatter});
    keepChannels(candidate, recording);
    std::mt19937 random(kBaseNoiseSeed);
    std::normal_distribution<double> normal(0, 1);
    for (Channel& channel : recording.channels)
        if (channel.name.rfind("base.", 0) == 0)
            for (double& value : channel.values) value += setup_.base_noise * normal(random);
    return recording;
}

RunMotion Rehearsal::measure(const PlannedRun& candidate) const {
    return estimateMotion(record(candidate), device_);
}

}  // namespace wems::identify
