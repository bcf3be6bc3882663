#include "identify/motion/channel_correction.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/bryant.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {

namespace {

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

/// @param displacements whether the recording has any
bool applies(const SensorFault& fault, const std::string& channel, bool displacements) {
    if (channel == fault.channel) return true;
    const auto name = parseChannelName(channel);
    if (!name) return false;
    const std::string side = name->part == Part::mobile ? "mobile" : name->part == Part::fixed ? "fixed" : "";
    if (side.empty()) return false;
    const std::string triad = side + "." + name->connection;
    if (name->derivative == Derivative::displacement) return fault.channel == side || fault.channel == triad;
    return name->derivative == Derivative::acceleration &&
           (fault.channel == triad + ".a" || (fault.channel == side && !displacements));
}

bool hasDisplacements(const Recording& recording) {
    return std::any_of(recording.channels.begin(), recording.channels.end(), [](const Channel& channel) {
        const auto name = parseChannelName(channel.name);
        return name && (name->part == Part::mobile || name->part == Part::fixed) &&
               name->derivative == Derivative::displacement;
    });
}

void rotateBack(Recording& recording, const SensorFault& fault, bool displacements) {
    const Eigen::Matrix3d R = rotationFromVector(fault.rotation).transpose();
    for (const char* side : {"mobile", "fixed"})
        for (const auto& connection : recording.connections(std::string(side) == "mobile" ? Part::mobile : Part::fixed))
            for (const char* prefix : {"", "a"}) {
                Channel* axis[3] = {nullptr, nullptr, nullptr};
                for (auto& channel : recording.channels)
                    for (int a = 0; a < 3; ++a)
                        if (channel.name == std::string(side) + "." + connection + "." + prefix + kAxes[a] &&
                            applies(fault, channel.name, displacements))
                            axis[a] = &channel;
                if (!axis[0] || !axis[1] || !axis[2]) continue;
                for (std::size_t k = 0; k < axis[0]->values.size(); ++k) {
                    const Eigen::Vector3d v =
                        R * Eigen::Vector3d(axis[0]->values[k], axis[1]->values[k], axis[2]->values[k]);
                    for (int a = 0; a < 3; ++a) axis[a]->values[k] = v[a];
                }
            }
}

}  // namespace

Recording correctChannels(const Recording& recording, const std::vector<SensorFault>& faults) {
    Recording result = recording;
    removeZeros(faults, result);
    const double interval = recording.sampleInterval();
    const bool displacements = hasDisplacements(recording);
    for (const auto& fault : faults) {
        for (auto& channel : result.channels) {
            if (!applies(fault, channel.name, displacements)) continue;
            if (fault.gain != 1)
                for (double& value : channel.values) value /= fault.gain;
            if (fault.delay != 0) channel.values = advance(channel.values, fault.delay, interval);
        }
        if (!fault.rotation.isZero(0.0)) rotateBack(result, fault, displacements);
    }
    return result;
}

}  // namespace wems::identify
