#include "models/model_tolerance.hpp"

#include <algorithm>
#include <cmath>

#include "models/parameter_access.hpp"
#include "models/parameter_name.hpp"
#include "models/sensor_reading.hpp"

namespace wems {
namespace {

using parameter::Target;

double largest(const Eigen::Vector3d& v) {
    return v.cwiseAbs().maxCoeff();
}

/// The largest entry of a mode among those of the same unit.
double calcShapeScale(const BracketMode& mode, const std::string& entry) {
    if (entry[0] == 'r') return largest(mode.rotation);
    if (entry.rfind("base.", 0) == 0) return largest(mode.base_participation);
    return std::max(largest(mode.translation), largest(mode.load_translation));
}

/// Moments and products in the order of kInertiaNames.
double calcInertiaScale(const Eigen::Matrix3d& I, int index) {
    if (index < 3) return I(index, index);
    const int row = index == 5 ? 1 : 0, column = index == 3 ? 1 : 2;
    return std::sqrt(I(row, row) * I(column, column));
}

std::optional<ToleranceOf> axisTolerance(const std::string& parameter) {
    if (parameter == "stiffness") return ToleranceOf::stiffness;
    if (parameter == "damping") return ToleranceOf::damping;
    return std::nullopt;
}

std::optional<ToleranceOf> stopTolerance(const std::string& parameter) {
    if (parameter == "clearance") return ToleranceOf::clearance;
    if (parameter == "stiffness") return ToleranceOf::stop_stiffness;
    return std::nullopt;
}

std::optional<double> calcConnectionTolerance(const MountModel& model, const std::string& name, const Target& target) {
    const bool stop = target.kind == Target::Kind::stop;
    const auto what = stop ? stopTolerance(target.parameter) : axisTolerance(target.parameter);
    if (!what) return std::nullopt;
    if (stop && parameter::findStop(parameter::lawOf(model, target), target.side) == nullptr) return std::nullopt;
    const Connection& connection = model.connections[target.connection];
    const Tolerances& item = connection.axis_tolerances[target.index];
    return toleranceOf(model, *what, item) * std::abs(getParameter(model, name));
}

double calcModeTolerance(const MountModel& model, const Target& target) {
    const BracketMode& mode = model.bracket[target.index];
    if (target.parameter == "frequency")
        return toleranceOf(model, ToleranceOf::mode_frequency, mode.tolerances) * mode.frequency;
    if (target.parameter == "damping_ratio")
        return toleranceOf(model, ToleranceOf::mode_damping_ratio, mode.tolerances) * mode.damping_ratio;
    return toleranceOf(model, ToleranceOf::mode_shape, mode.tolerances) * calcShapeScale(mode, target.parameter);
}

}  // namespace

double toleranceOf(const MountModel& model, ToleranceOf what, const Tolerances& item) {
    if (const auto own = item.find(what)) return *own;
    return model.tolerances.find(what).value_or(keyOf(what).standard);
}

bool isExactlyKnown(const MountModel& model) {
    const auto statesAny = [](const Tolerances& item) {
        for (std::size_t i = 0; i < kToleranceKeys.size(); ++i)
            if (item.find(static_cast<ToleranceOf>(i)).value_or(0) > 0) return true;
        return false;
    };
    for (std::size_t i = 0; i < kToleranceKeys.size(); ++i)
        if (toleranceOf(model, static_cast<ToleranceOf>(i)) > 0) return false;
    if (statesAny(model.body.tolerances)) return false;
    for (const Connection& connection : model.connections)
        if (statesAny(connection.tolerances) ||
            std::any_of(connection.axis_tolerances.begin(), connection.axis_tolerances.end(), statesAny))
            return false;
    return std::none_of(model.bracket.begin(), model.bracket.end(),
                        [&](const BracketMode& mode) { return statesAny(mode.tolerances); }) &&
           std::none_of(model.sensors.begin(), model.sensors.end(),
                        [&](const SensorFault& sensor) { return statesAny(sensor.tolerances); });
}

Tolerances sensorTolerances(const MountModel& model, const std::string& channel) {
    Tolerances result;
    std::array<std::size_t, kToleranceKeys.size()> length{};
    for (const SensorFault& sensor : model.sensors) {
        const std::string& group = sensor.channel;
        if (!concernsChannel(group, channel)) continue;
        for (std::size_t k = 0; k < kToleranceKeys.size(); ++k) {
            const auto what = static_cast<ToleranceOf>(k);
            const auto given = sensor.tolerances.find(what);
            if (!given || group.size() < length[k]) continue;
            result.set(what, given);
            length[k] = group.size();
        }
    }
    return result;
}

std::optional<double> parameterTolerance(const MountModel& model, const std::string& name) {
    const Target target = parameter::parse(model, name);
    switch (target.kind) {
        case Target::Kind::axis:
        case Target::Kind::stop:
            return calcConnectionTolerance(model, name, target);
        case Target::Kind::mass:
            return toleranceOf(model, ToleranceOf::mass, model.body.tolerances) * model.body.mass;
        case Target::Kind::center_of_gravity:
            return toleranceOf(model, ToleranceOf::center_of_gravity, model.body.tolerances);
        case Target::Kind::inertia:
            return toleranceOf(model, ToleranceOf::inertia, model.body.tolerances) *
                   calcInertiaScale(model.body.inertia, target.index);
        case Target::Kind::spin:
            return std::nullopt;
        case Target::Kind::mode:
            return calcModeTolerance(model, target);
        case Target::Kind::load:
            return toleranceOf(model, ToleranceOf::load_gain) * std::abs(getParameter(model, name));
        case Target::Kind::sensor: {
            const Tolerances item = sensorTolerances(model, target.channel);
            if (target.parameter == "zero") return std::nullopt;
            if (target.parameter == "delay") return toleranceOf(model, ToleranceOf::sensor_delay, item);
            return toleranceOf(model, ToleranceOf::sensor_gain, item) * std::abs(getParameter(model, name));
        }
        case Target::Kind::sensor_rotation:
            return toleranceOf(model, ToleranceOf::sensor_rotation, sensorTolerances(model, target.channel));
    }
    return std::nullopt;
}

}  // namespace wems
