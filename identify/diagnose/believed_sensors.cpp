#include "identify/diagnose/believed_sensors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "models/bryant.hpp"
#include "models/sensor_reading.hpp"

namespace wems::identify {

namespace {

/// A number of a sensor's fault: `mobile.1.az` and `gain`, `mobile.1` and `rx`.
struct FaultName {
    std::string channel, key;
};

std::optional<FaultName> parseFault(const std::string& name) {
    const auto dot = name.rfind('.');
    if (dot == std::string::npos) return std::nullopt;
    FaultName fault{name.substr(0, dot), name.substr(dot + 1)};
    const bool of_sensor = fault.channel.rfind("mobile", 0) == 0 || fault.channel.rfind("fixed", 0) == 0;
    const auto& key = fault.key;
    const bool is_fault = key == "gain" || key == "delay" || key == "rx" || key == "ry" || key == "rz";
    if (!of_sensor || !is_fault) return std::nullopt;
    return fault;
}

Eigen::Vector3d vectorOf(const Eigen::Matrix3d& R) {
    const Eigen::AngleAxisd turn(R);
    return turn.angle() * turn.axis();
}

void shift(CauseParameter& parameter, double by) {
    parameter.value += by;
    parameter.lower += by;
    parameter.upper += by;
}

class BelievedSensors {
public:
    BelievedSensors(const std::vector<SensorFault>& faults, const std::vector<Recording>& recordings)
        : faults_(faults), recordings_(recordings) {}

    /// @param found rotation vector that was found beside the number, rad
    void addTo(CauseParameter& parameter, const Eigen::Vector3d& found) const {
        const auto fault = parseFault(parameter.name);
        if (!fault) return;
        const SensorReading believed = meanOf(fault->channel);
        if (fault->key == "gain") {
            for (double* value : {&parameter.value, &parameter.lower, &parameter.upper}) *value *= believed.gain;
            if (parameter.lower > parameter.upper) std::swap(parameter.lower, parameter.upper);
        } else if (fault->key == "delay") {
            shift(parameter, believed.delay);
        } else {
            const Eigen::Index axis = fault->key[1] - 'x';
            shift(parameter, vectorOf(believed.R_TS * rotationFromVector(found))[axis] - found[axis]);
        }
    }

    void addTo(std::vector<CauseParameter>& parameters) const {
        Eigen::Vector3d found = Eigen::Vector3d::Zero();
        for (const CauseParameter& parameter : parameters) {
            const auto fault = parseFault(parameter.name);
            if (fault && fault->key[0] == 'r') found[fault->key[1] - 'x'] = parameter.value;
        }
        for (CauseParameter& parameter : parameters) addTo(parameter, found);
    }

private:
    /// Gain and delay: mean of the channels; rotation: of the first of them.
    SensorReading meanOf(const std::string& group) const {
        SensorReading mean;
        double count = 0, gain = 0, delay = 0;
        for (const Recording& recording : recordings_)
            for (const Channel& channel : recording.channels) {
                if (!concernsChannel(group, channel.name)) continue;
                const SensorReading own = readingOf(faults_, channel.name);
                if (count++ == 0) mean.R_TS = own.R_TS;
                gain += own.gain;
                delay += own.delay;
            }
        if (count > 0) {
            mean.gain = gain / count;
            mean.delay = delay / count;
        }
        return mean;
    }

    const std::vector<SensorFault>& faults_;
    const std::vector<Recording>& recordings_;
};

/// What was found acts on the truth before what was believed does.
std::vector<SensorFault> join(std::vector<SensorFault> found, const std::vector<SensorFault>& believed) {
    std::vector<SensorFault> all = believed;
    for (SensorFault& own : all) {
        const auto same = std::find_if(found.begin(), found.end(),
                                       [&](const SensorFault& fault) { return fault.channel == own.channel; });
        if (same == found.end()) continue;
        own.gain *= same->gain;
        own.delay += same->delay;
        own.rotation = vectorOf(rotationFromVector(own.rotation) * rotationFromVector(same->rotation));
        found.erase(same);
    }
    all.insert(all.begin(), found.begin(), found.end());
    return all;
}

}  // namespace

MountModel withoutFaults(MountModel model) {
    for (SensorFault& sensor : model.sensors) {
        const Tolerances tolerances = sensor.tolerances;
        const std::string channel = sensor.channel;
        sensor = {};
        sensor.channel = channel;
        sensor.tolerances = tolerances;
    }
    return model;
}

void addBelievedSensors(const std::vector<SensorFault>& believed, const std::vector<Recording>& recordings,
                        Diagnosis& diagnosis) {
    const BelievedSensors sensors(believed, recordings);
    for (Cause& cause : diagnosis.causes) {
        sensors.addTo(cause.parameters);
        for (Rival& rival : cause.rivals) sensors.addTo(rival.parameters);
    }
    for (Adjustment& adjustment : diagnosis.adjustments) {
        sensors.addTo(adjustment.parameter, Eigen::Vector3d::Zero());
        CauseParameter start = {adjustment.parameter.name, {}, adjustment.believed, 0, 0};
        sensors.addTo(start, Eigen::Vector3d::Zero());
        adjustment.believed = start.value;
    }
    diagnosis.extended.sensors = join(std::move(diagnosis.extended.sensors), believed);
}

}  // namespace wems::identify
