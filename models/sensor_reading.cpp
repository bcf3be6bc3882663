#include "models/sensor_reading.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "models/bryant.hpp"
#include "models/common/error.hpp"

namespace wems {

namespace {

// Volume that the three axes span: below it what is taken back has a thousand times the noise.
constexpr double kFlat = 1e-3;

/// Values at times later by `delay` (s).
std::vector<double> advance(const std::vector<double>& values, double delay, double interval) {
    const auto count = static_cast<long>(values.size());
    const auto at = [&](long k) { return values[std::clamp(k, 0L, count - 1)]; };
    std::vector<double> result(values.size());
    for (long k = 0; k < count; ++k) {
        const double position = static_cast<double>(k) + delay / interval;
        const auto i = static_cast<long>(std::floor(position));
        const double u = position - static_cast<double>(i);
        const double a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
        // Lagrange's cubic through four neighbours.
        result[k] = -a * u * (u - 1) * (u - 2) / 6 + b * (u + 1) * (u - 1) * (u - 2) / 2 -
                    c * (u + 1) * u * (u - 2) / 2 + d * (u + 1) * u * (u - 1) / 6;
    }
    return result;
}

char kindOf(Derivative derivative) {
    switch (derivative) {
        case Derivative::displacement:
            return 'd';
        case Derivative::velocity:
            return 'v';
        case Derivative::acceleration:
            return 'a';
        case Derivative::force:
            break;
    }
    return 'f';
}

/// Places of the channels x, y, z of the triax that a channel belongs to; −1 where one was not recorded.
Eigen::Array3i findTriax(const Recording& recording, const ChannelName& of) {
    Eigen::Array3i triax = Eigen::Array3i::Constant(-1);
    for (int axis = 0; axis < 3; ++axis) {
        ChannelName wanted = of;
        wanted.axis = axis;
        const std::string name = formatChannelName(wanted);
        for (std::size_t c = 0; c < recording.channels.size(); ++c)
            if (recording.channels[c].name == name) triax[axis] = static_cast<int>(c);
    }
    return triax;
}

void turnBack(const Eigen::Array3i& triax, const Eigen::Matrix3d& measured_T, Recording& recording) {
    const Eigen::Matrix3d T_measured = measured_T.inverse();
    const auto values = [&](int axis) -> std::vector<double>& { return recording.channels[triax[axis]].values; };
    for (std::size_t k = 0; k < values(0).size(); ++k) {
        const Eigen::Vector3d v = T_measured * Eigen::Vector3d(values(0)[k], values(1)[k], values(2)[k]);
        for (int axis = 0; axis < 3; ++axis) values(axis)[k] = v[axis];
    }
}

}  // namespace

bool concernsChannel(const std::string& group, const std::string& channel) {
    if (channel == group || channel.rfind(group + ".", 0) == 0) return true;
    const auto name = parseChannelName(channel);
    if (!name || (name->part != Part::mobile && name->part != Part::fixed)) return false;
    const std::string place = channel.substr(0, channel.rfind('.'));
    return group == place + "." + kindOf(name->derivative);
}

SensorReading readingOf(const std::vector<SensorFault>& faults, const std::string& channel) {
    SensorReading reading;
    for (const SensorFault& fault : faults) {
        if (!concernsChannel(fault.channel, channel)) continue;
        reading.gain *= fault.gain;
        reading.delay += fault.delay;
        reading.zero += fault.zero;
        reading.R_TS = rotationFromVector(fault.rotation) * reading.R_TS;
    }
    return reading;
}

Recording correctChannels(const Recording& recording, const std::vector<SensorFault>& faults) {
    Recording result = recording;
    if (faults.empty()) return result;
    std::vector<SensorReading> readings;
    for (Channel& channel : result.channels) {
        readings.push_back(readingOf(faults, channel.name));
        const SensorReading& reading = readings.back();
        if (reading.gain == 0)
            throw InputError({recording.file, 0, channel.name},
                             "says nothing of the truth: the model's sensor has gain 0",
                             "a recording without it, or another gain");
        if (reading.zero != 0 || reading.gain != 1)
            for (double& value : channel.values) value = (value - reading.zero) / reading.gain;
        if (reading.delay != 0) channel.values = advance(channel.values, reading.delay, recording.sampleInterval());
    }
    for (std::size_t c = 0; c < result.channels.size(); ++c) {
        const auto name = parseChannelName(result.channels[c].name);
        if (!name) continue;
        const Eigen::Array3i triax = findTriax(result, *name);
        if (triax.minCoeff() < 0 || triax[0] != static_cast<int>(c)) continue;  // whole ones, each once
        Eigen::Matrix3d measured_T;
        for (int axis = 0; axis < 3; ++axis) measured_T.row(axis) = readings[triax[axis]].R_TS.row(axis);
        if (measured_T.isIdentity(0.0)) continue;
        if (std::abs(measured_T.determinant()) < kFlat)
            throw InputError({recording.file, 0, result.channels[c].name},
                             "measures, by the model's sensors, what the other axes of its triax measure",
                             "three axes that are not in a plane");
        turnBack(triax, measured_T, result);
    }
    return result;
}

}  // namespace wems
