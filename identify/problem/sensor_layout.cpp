#include "identify/problem/sensor_layout.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "identify/motion/fourier.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

template <typename T, typename Name>
int indexOf(std::vector<T>& list, const std::string& wanted, Name name, const T& fresh) {
    const auto found = std::find_if(list.begin(), list.end(), [&](const T& item) { return name(item) == wanted; });
    if (found != list.end()) return static_cast<int>(found - list.begin());
    list.push_back(fresh);
    return static_cast<int>(list.size()) - 1;
}

/// Where a sensor sits that has no place of its own; -1: at none.
int findConnection(const MountModel& model, const MarkerChannel& marker) {
    for (std::size_t c = 0; c < model.connections.size(); ++c)
        if (model.connections[c].name == marker.station && model.connections[c].position == marker.position)
            return static_cast<int>(c);
    return -1;
}

/// A table that nothing but base.* shows: its accelerations are those of the fixed part's origin.
void addBase(const std::vector<Recording>& recordings, SensorLayout& layout) {
    for (const SensorGroup& group : layout.groups)
        if (group.part == Part::fixed) return;
    SensorGroup group{Part::fixed, Derivative::acceleration, {}};
    const auto group_index = static_cast<int>(layout.groups.size());
    for (const Recording& recording : recordings)
        for (const Channel& channel : recording.channels) {
            const auto name = parseChannelName(channel.name);
            if (!name || name->part != Part::base || layout.findChannel(channel.name) >= 0) continue;
            SensorChannel sensor;
            sensor.name = channel.name;
            sensor.group = group_index;
            sensor.direction = Eigen::Vector3d::Unit(name->axis);
            if (group.channels.empty()) {
                layout.triaxes.push_back({"base", group_index});
                layout.stations.emplace_back("base");
            }
            sensor.triax = static_cast<int>(layout.triaxes.size()) - 1;
            sensor.station = static_cast<int>(layout.stations.size()) - 1;
            group.channels.push_back(static_cast<int>(layout.channels.size()));
            layout.channels.push_back(sensor);
        }
    if (!group.channels.empty()) layout.groups.push_back(group);
}

/// Samples of x(t + delay), cubic through four neighbours.
std::vector<double> shiftSamples(const std::vector<double>& x, double shift) {
    const auto count = static_cast<long>(x.size());
    std::vector<double> result(x.size());
    const auto at = [&](long k) { return x[std::clamp(k, 0L, count - 1)]; };
    const auto whole = static_cast<long>(std::floor(shift));
    const double u = shift - static_cast<double>(whole);
    for (long k = 0; k < count; ++k) {
        const long i = k + whole;
        result[k] = -at(i - 1) * u * (u - 1) * (u - 2) / 6 + at(i) * (u + 1) * (u - 1) * (u - 2) / 2 -
                    at(i + 1) * (u + 1) * u * (u - 2) / 2 + at(i + 2) * (u + 1) * u * (u - 1) / 6;
    }
    return result;
}

/// The inverse of a first-order high pass, x = y + ω_c ∫ y, above a frequency. Below it the integral of the noise would
/// drift, and of a drift a window lets a little through everywhere.
void removeHighPass(std::vector<double>& y, double corner, double slowest, double interval) {
    const auto count = static_cast<int>(y.size());
    const Fourier fourier(count);
    Eigen::MatrixXcd spectrum = fourier.forward(Eigen::Map<const Eigen::RowVectorXd>(y.data(), count));
    const double bin = 1 / (fourier.size() * interval);
    for (Eigen::Index k = 0; k < spectrum.cols(); ++k) {
        const double frequency = bin * static_cast<double>(k);
        spectrum(0, k) *= frequency < slowest ? 0.0 : std::complex<double>(0, -corner / frequency);
    }
    Eigen::Map<Eigen::RowVectorXd>(y.data(), count) += fourier.inverse(spectrum, count);
}

/// Motion of the point `position`, as displacement from rest or acceleration, without what the sensor has wrong.
/// What a step of a point on a part makes of its motion, at each sample (3 x 3).
std::vector<Eigen::Matrix3d> calcPlaceEffect(const PartMotion& part, Derivative derivative) {
    std::vector<Eigen::Matrix3d> effect(part.theta.cols());
    for (Eigen::Index k = 0; k < part.theta.cols(); ++k) {
        const Eigen::Matrix3d R = rotationFromVector(part.theta.col(k));
        if (derivative == Derivative::displacement) {
            effect[k] = R - Eigen::Matrix3d::Identity();
        } else {
            const Eigen::Matrix3d spin = crossMatrix(part.w.col(k));
            effect[k] = (crossMatrix(part.alpha.col(k)) + spin * spin) * R;
        }
    }
    return effect;
}

Eigen::Vector3d calcPointMotion(const PartMotion& part, Derivative derivative, const Eigen::Vector3d& position,
                                Eigen::Index k) {
    const Eigen::Matrix3d R = rotationFromVector(part.theta.col(k));
    if (derivative == Derivative::displacement) return part.p.col(k) + R * position - position;
    const Eigen::Vector3d r = R * position, w = part.w.col(k);
    return part.a.col(k) + part.alpha.col(k).cross(r) + w.cross(w.cross(r));
}

}  // namespace

int SensorLayout::findChannel(const std::string& name) const {
    const auto found =
        std::find_if(channels.begin(), channels.end(), [&](const SensorChannel& c) { return c.name == name; });
    return found == channels.end() ? -1 : static_cast<int>(found - channels.begin());
}

bool SensorLayout::hasAccelerations(Part part) const {
    return std::any_of(groups.begin(), groups.end(), [part](const SensorGroup& group) {
        return group.part == part && group.derivative == Derivative::acceleration;
    });
}

SensorLayout makeSensorLayout(const std::vector<Recording>& recordings, const MountModel& model) {
    SensorLayout layout;
    for (const Part part : {Part::mobile, Part::fixed})
        for (const Derivative derivative : {Derivative::displacement, Derivative::acceleration}) {
            SensorGroup group{part, derivative, {}};
            const auto group_index = static_cast<int>(layout.groups.size());
            const std::string side = part == Part::mobile ? "mobile." : "fixed.";
            for (const Recording& recording : recordings)
                for (const MarkerChannel& marker : collectChannels(recording, model, part, derivative).channels) {
                    if (layout.findChannel(marker.name) >= 0) continue;
                    SensorChannel channel;
                    channel.name = marker.name;
                    channel.group = group_index;
                    channel.position = marker.position;
                    channel.connection = findConnection(model, marker);
                    channel.direction = marker.direction;
                    channel.turning = marker.turning;
                    if (part == Part::mobile) channel.freedom = calcFreedom(model.body);
                    // An accelerometer and the marker beside it are two sensors at two places.
                    const std::string triax =
                        side + marker.station + (derivative == Derivative::acceleration ? ".a" : "");
                    channel.station = indexOf(
                        layout.stations, triax, [](const std::string& s) { return s; }, triax);
                    channel.triax = indexOf(
                        layout.triaxes, triax, [](const SensorTriax& t) { return t.name; },
                        SensorTriax{triax, group_index});
                    group.channels.push_back(static_cast<int>(layout.channels.size()));
                    layout.channels.push_back(channel);
                }
            if (!group.channels.empty()) layout.groups.push_back(group);
        }
    addBase(recordings, layout);
    return layout;
}

SensorErrors::SensorErrors(const SensorLayout& layout)
    : gain(Eigen::VectorXd::Zero(layout.channels.size())),
      delay(gain),
      rotation(Eigen::Matrix3Xd::Zero(3, layout.triaxes.size())),
      place(Eigen::Matrix3Xd::Zero(3, layout.stations.size())) {}

bool SensorErrors::operator==(const SensorErrors& other) const {
    return gain == other.gain && delay == other.delay && rotation == other.rotation && place == other.place &&
           corner == other.corner;
}

bool SensorErrors::isZero() const {
    return gain.isZero(0.0) && delay.isZero(0.0) && rotation.isZero(0.0) && place.isZero(0.0) && corner[0] == 0 &&
           corner[1] == 0;
}

namespace {

using Triads = std::vector<std::array<Channel*, 3>>;

/// The channels of each triax along x, y, z; null where there is none.
Triads findTriads(Recording& recording, const SensorLayout& layout) {
    Triads triads(layout.triaxes.size(), {nullptr, nullptr, nullptr});
    for (Channel& channel : recording.channels) {
        const int index = layout.findChannel(channel.name);
        if (index < 0) continue;
        const SensorChannel& sensor = layout.channels[index];
        for (int a = 0; a < 3; ++a)
            if (sensor.direction == Eigen::Vector3d::Unit(a)) triads[sensor.triax][a] = &channel;
    }
    return triads;
}

/// Whether the three axes of each triax are recorded, so that it can be turned back by itself.
std::vector<bool> findComplete(const Recording& recording, const SensorLayout& layout) {
    std::vector<std::array<bool, 3>> axes(layout.triaxes.size(), {false, false, false});
    for (const SensorChannel& sensor : layout.channels)
        if (recording.find(sensor.name))
            for (std::size_t a = 0; a < 3; ++a)
                if (sensor.direction == Eigen::Vector3d::Unit(static_cast<Eigen::Index>(a)))
                    axes[sensor.triax].at(a) = true;
    std::vector<bool> complete;
    for (const auto& [x, y, z] : axes) complete.push_back(x && y && z);
    return complete;
}

}  // namespace

Recording correctSensors(const Recording& recording, const SensorLayout& layout, const SensorErrors& errors,
                         double lowest) {
    Recording result = recording;
    if (errors.isZero()) return result;
    const double interval = recording.sampleInterval();
    for (Channel& channel : result.channels) {
        const int index = layout.findChannel(channel.name);
        if (index < 0) continue;
        const SensorGroup& group = layout.groups[layout.channels[index].group];
        const double gain = 1 + errors.gain[index];
        if (gain != 1)
            for (double& value : channel.values) value /= gain;
        if (errors.delay[index] != 0) channel.values = shiftSamples(channel.values, errors.delay[index] / interval);
        const double corner = errors.corner[group.part == Part::mobile ? 0 : 1];
        if (group.derivative == Derivative::acceleration && corner != 0)
            removeHighPass(channel.values, corner, kSlowestIntegrated * lowest, interval);
    }
    const Triads triads = findTriads(result, layout);
    const std::vector<bool> complete = findComplete(recording, layout);
    for (std::size_t t = 0; t < triads.size(); ++t) {
        const auto& triad = triads[t];
        const Eigen::Vector3d rotation = errors.rotation.col(t);
        if (!complete[t] || rotation.isZero(0.0)) continue;
        const Eigen::Matrix3d back = rotationFromVector(rotation).transpose();
        for (std::size_t k = 0; k < triad[0]->values.size(); ++k) {
            const Eigen::Vector3d v =
                back * Eigen::Vector3d(triad[0]->values[k], triad[1]->values[k], triad[2]->values[k]);
            for (std::size_t a = 0; a < 3; ++a) triad[a]->values[k] = v[a];
        }
    }
    return result;
}

bool placeSensors(Recording& recording, const SensorLayout& layout, const SensorErrors& errors,
                  const RunMotion& motion) {
    const std::vector<bool> complete = findComplete(recording, layout);
    std::map<std::pair<Part, Derivative>, std::vector<Eigen::Matrix3d>> effects;
    bool moved = false;
    for (Channel& channel : recording.channels) {
        const int index = layout.findChannel(channel.name);
        if (index < 0) continue;
        const SensorChannel& sensor = layout.channels[index];
        const SensorGroup& group = layout.groups[sensor.group];
        const Eigen::Vector3d place = errors.place.col(sensor.station), rotation = errors.rotation.col(sensor.triax);
        const PartMotion& part = group.part == Part::mobile ? motion.mobile : motion.fixed;
        const bool turned = !rotation.isZero(0.0) && !complete[sensor.triax];
        const Eigen::Vector3d seen =
            turned ? Eigen::Vector3d(rotationFromVector(rotation).transpose() * sensor.direction) : sensor.direction;
        if (!turned && place.isZero(0.0)) continue;
        moved = true;
        if (!place.isZero(0.0)) {
            auto& effect = effects[{group.part, group.derivative}];
            if (effect.empty()) effect = calcPlaceEffect(part, group.derivative);
            for (std::size_t k = 0; k < channel.values.size(); ++k) channel.values[k] -= seen.dot(effect[k] * place);
        }
        if (!turned) continue;
        for (std::size_t k = 0; k < channel.values.size(); ++k)
            channel.values[k] -=
                (seen - sensor.direction).dot(calcPointMotion(part, group.derivative, sensor.position, k));
    }
    return moved;
}

SensorLayout moveSensors(SensorLayout layout, const SensorErrors& errors, const Recording& recording) {
    const std::vector<bool> complete = findComplete(recording, layout);
    for (SensorChannel& channel : layout.channels) {
        channel.position += errors.place.col(channel.station);
        if (!complete[channel.triax])
            channel.direction = rotationFromVector(errors.rotation.col(channel.triax)).transpose() * channel.direction;
    }
    return layout;
}

}  // namespace wems::identify
