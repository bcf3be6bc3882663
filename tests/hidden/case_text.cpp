#include "tests/hidden/case_text.hpp"

#include <cmath>

#include "models/common/format_number.hpp"
#include "models/parameter_access.hpp"
#include "tests/hidden/time_scale.hpp"

namespace wems::hidden {
namespace {

using nlohmann::json;

/// What a result calls a parameter of a cause.
std::string reportName(const std::string& name) {
    if (name.rfind("body.", 0) == 0 || name.rfind("load.", 0) == 0) return name.substr(name.rfind('.') + 1);
    return name;
}

json number(double value) {
    return std::isfinite(value) ? json(value) : json();
}

json vector(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

json formatErrors(const GroupErrors& errors) {
    return {{"identification", number(errors.identification)}, {"validation", number(errors.validation)}};
}

json formatEffect(const Effect& effect, const MountModel& truth) {
    json parameters = json::object();
    for (const auto& name : effect.names) parameters[reportName(name)] = number(getParameter(truth, name));
    json entry{
        {"cause", effect.cause}, {"variant", effect.variant}, {"where", effect.where}, {"parameters", parameters}};
    if (effect.variant == "drop_out") entry["gain_over_frequency"] = truth.load->gain_over_frequency;
    return entry;
}

/// True gain, rotation and place of each triax: its own error and the hidden fault together, which act in this order.
/// A place counts from where the believed model has the connection. And the corner of AC coupling.
void addSensors(const HiddenCase& hidden, const std::string& side, const std::string& prefix, const TriaxErrors& errors,
                bool rotations, json& values) {
    const std::size_t count = hidden.set_up.oneAxis() ? 1 : hidden.truth.connections.size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::string triax = side + "." + hidden.truth.connections[i].name;
        const Eigen::Index column = i;
        bool turned = false;
        for (const auto& sensor : hidden.truth.sensors) turned |= sensor.channel == triax && !sensor.rotation.isZero(0);
        for (int a = hidden.set_up.oneAxis() ? 2 : 0; a < 3; ++a) {
            const std::string channel = triax + "." + prefix + kAxes[a];
            double gain = errors.gain(a, column);
            for (const auto& sensor : hidden.truth.sensors)
                if (sensor.channel == side || sensor.channel == triax || sensor.channel == channel) gain *= sensor.gain;
            values[channel + ".gain"] = gain;
        }
        for (int a = 0; rotations && !turned && a < 3; ++a)
            values[triax + ".r" + kAxes[a]] = errors.rotation(a, column);
        const Eigen::Vector3d place =
            errors.place.col(column) + hidden.truth.connections[i].position - hidden.believed.connections[i].position;
        for (int a = 0; a < 3; ++a) values[triax + (prefix.empty() ? "" : ".a") + ".position." + kAxes[a]] = place[a];
    }
    if (!prefix.empty() && hidden.sensors.coupling > 0) values[side + ".a.corner"] = hidden.sensors.coupling;
}

/// Every number of the device as a result would name it.
json listParameters(const HiddenCase& hidden, const MountModel& truth) {
    json values = json::object();
    const auto add = [&](const std::string& name) { values[name] = number(getParameter(truth, name)); };
    add("body.mass");
    for (const char* axis : kAxes) add(std::string("body.center_of_gravity.") + axis);
    for (const char* name : {"Ixx", "Iyy", "Izz"}) add(std::string("body.inertia.") + name);
    for (const auto& connection : truth.connections)
        for (std::size_t a = 0; a < 3; ++a) {
            values[connection.name + ".position." + kAxes[a]] = connection.position[static_cast<Eigen::Index>(a)];
            const auto& law = connection.axis[a];
            const std::string axis = connection.name + "." + kAxes[a];
            if (law.stiffness == 0) continue;
            add(axis + ".stiffness");
            add(axis + ".damping");
            for (const auto& stop : law.stops) {
                const std::string side = axis + (stop.side == Side::positive ? ".+" : ".-");
                add(side + ".clearance");
                add(side + ".stiffness");
            }
        }
    for (std::size_t j = 1; j <= truth.bracket.size(); ++j)
        for (const char* name : {".frequency", ".damping_ratio"}) add(std::to_string(j) + name);
    // Of several axes only the products of the common gain and their own are told.
    if (hidden.set_up.loaded() && hidden.set_up.oneAxis() &&
        !(truth.load && truth.load->gain_over_frequency.size() > 1))
        values["load.gain"] = getParameter(truth, "load.gain") / hidden.sensors.load_gain.z();
    const bool both = hidden.displacement_noise > 0 && hidden.acceleration_noise > 0;
    const auto& errors = hidden.sensors;
    if (hidden.displacement_noise > 0) {
        addSensors(hidden, "mobile", "", errors.mobile_displacement, !both, values);
        if (hidden.set_up.records_fixed) addSensors(hidden, "fixed", "", errors.fixed_displacement, !both, values);
    }
    if (hidden.acceleration_noise > 0) {
        addSensors(hidden, "mobile", "a", errors.mobile_acceleration, !both, values);
        if (hidden.set_up.records_fixed) addSensors(hidden, "fixed", "a", errors.fixed_acceleration, !both, values);
    }
    return values;
}

json formatRuns(const HiddenCase& hidden) {
    auto runs = json::array();
    const double T = hidden.time_scale;
    for (std::size_t r = 0; r < hidden.runs.size(); ++r) {
        const RunPlan& plan = hidden.runs[r];
        runs.push_back({{"excitation", formatExcitation(plan)},
                        {"from_to", {kLowest / T, kHighest / T}},
                        {"duration", plan.duration * T},
                        {"sample_rate", hidden.rate / T},
                        {"direction", vector(plan.direction)},
                        {"level", plan.level / (T * T)},
                        {"amplification", hidden.amplification[r]}});
    }
    return runs;
}

}  // namespace

std::string formatModel(const HiddenCase& hidden, const MountModel& model, const Tolerances& tolerances,
                        const std::string& bracket_file) {
    MountModel slow = slowDown(model, hidden.time_scale);
    slow.replaced_modes.clear();  // its own modes file has them
    slow.tolerances = tolerances;
    return formatMountModel(slow, bracket_file);
}

json formatTruth(const HiddenCase& hidden, const ModelErrors& model_errors) {
    const double T = hidden.time_scale;
    const MountModel truth = slowDown(hidden.truth, T);
    auto causes = json::array();
    for (const auto& effect : hidden.effects) causes.push_back(formatEffect(effect, truth));
    const bool displacement = hidden.displacement_noise > 0, acceleration = hidden.acceleration_noise > 0;
    const SensorErrors& errors = hidden.sensors;
    json result{{"class", hidden.kind},
                {"causes", causes},
                {"set_up", formatSetUp(hidden.set_up)},
                {"recorded", displacement ? acceleration ? "both" : "displacements" : "accelerations"},
                {"time_scale", T},
                {"share_of_small_errors", hidden.small_errors},
                {"change", {{"identification", hidden.change[0]}, {"validation", hidden.change[1]}}},
                {"error_of_true_model", formatErrors(model_errors.truth)},
                {"error_without_effects", formatErrors(model_errors.without)},
                {"error_of_believed_model", formatErrors(model_errors.believed)},
                {"noise",
                 {{"displacement", hidden.displacement_noise},
                  {"acceleration", hidden.acceleration_noise / (T * T)},
                  {"pink_over_white", errors.pink},
                  {"hum_over_white", errors.hum},
                  {"hum_frequency", errors.hum_frequency},
                  {"ac_coupling", errors.coupling},
                  {"filtered", errors.filtered},
                  {"load_gain", errors.load_gain},
                  {"load_noise", errors.load_noise}}},
                {"runs", formatRuns(hidden)},
                {"parameters", listParameters(hidden, truth)}};
    if (hidden.outside.kind != OutsideEffect::Kind::none)
        result["outside"] = {
            {"kind", formatKind(hidden.outside.kind)},
            {"where", std::to_string(hidden.outside.connection + 1) + "." + kAxes[hidden.outside.axis]},
            {"size", hidden.outside.size / (T * T)},
            {"frequency", hidden.outside.frequency / T}};
    return result;
}

}  // namespace wems::hidden
