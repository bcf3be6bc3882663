#include "plugin/prescribed_motion.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_table.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"
#include "models/sampled_motion.hpp"
#include "plugin/linear_analysis.hpp"

namespace wems::plugin {
namespace {

std::optional<Eigen::VectorXd> findChannel(const Recording& recording, const ChannelName& name) {
    const Channel* channel = recording.find(formatChannelName(name));
    if (channel == nullptr) return std::nullopt;
    return Eigen::Map<const Eigen::VectorXd>(channel->values.data(), channel->values.size());
}

/// Recorded as such, or as mobile end minus fixed end; a fixed part without channels stands still.
std::optional<Eigen::VectorXd> findRelative(const Recording& recording, const std::string& connection, int axis,
                                            Derivative what) {
    if (auto relative = findChannel(recording, {Part::relative, connection, axis, what})) return relative;
    auto mobile = findChannel(recording, {Part::mobile, connection, axis, what});
    const auto fixed = findChannel(recording, {Part::fixed, connection, axis, what});
    if (mobile && fixed) return Eigen::VectorXd(*mobile - *fixed);
    return recording.connections(Part::fixed).empty() ? mobile : std::nullopt;
}

std::vector<std::string> listConnections(const Recording& recording) {
    std::vector<std::string> names;
    for (const Part part : {Part::relative, Part::mobile})
        for (const std::string& name : recording.connections(part))
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names;
}

/// The model's law for a recorded connection; nullptr if the model has none of that name.
const Connection* findConnection(const MountModel& model, const std::string& name, bool only) {
    for (const Connection& connection : model.connections)
        if (connection.name == name) return &connection;
    return only && model.connections.size() == 1 ? &model.connections.front() : nullptr;
}

PrescribedAxis summarise(const std::string& connection, int axis, const Eigen::VectorXd& q, const Eigen::VectorXd& f) {
    PrescribedAxis result{connection, axis, q.cwiseAbs().maxCoeff(), f.cwiseAbs().maxCoeff(), 0};
    for (Eigen::Index k = 1; k < q.size(); ++k) result.energy_put_in += 0.5 * (f[k] + f[k - 1]) * (q[k] - q[k - 1]);
    return result;
}

void addChannel(const ChannelName& name, const char* unit, const Eigen::VectorXd& values, Recording& recording) {
    Channel channel;
    channel.name = formatChannelName(name);
    channel.unit = unit;
    channel.values.assign(values.begin(), values.end());
    recording.channels.push_back(std::move(channel));
}

}  // namespace

PrescribedRun followMotion(const MountModel& model, const Recording& motion) {
    PrescribedRun run;
    run.recording.time = motion.time;
    const auto names = listConnections(motion);
    const Eigen::Map<const Eigen::VectorXd> time(motion.time.data(), motion.time.size());
    for (const std::string& name : names) {
        const Connection* connection = findConnection(model, name, names.size() == 1);
        if (connection == nullptr) continue;
        for (int axis = 0; axis < 3; ++axis) {
            const auto q = findRelative(motion, name, axis, Derivative::displacement);
            if (!q) continue;
            auto v = findRelative(motion, name, axis, Derivative::velocity);
            if (!v) v = derive(*q, motion.sampleInterval(), chooseHalfWidth(*q), 1);
            const AxisLaw& law = connection->axis[axis];
            const Eigen::VectorXd f = calcForceAlong(law, time, *q, *v);
            addChannel({Part::relative, name, axis, Derivative::displacement}, "m", *q, run.recording);
            addChannel({Part::force, name, axis, Derivative::force}, "N", f, run.recording);
            run.axes.push_back(summarise(name, axis, *q, f));
        }
    }
    if (run.axes.empty()) {
        std::string accepted;
        for (const Connection& connection : model.connections)
            accepted += (accepted.empty() ? "relative." : ", relative.") + connection.name + ".<x|y|z>";
        throw InputError({motion.file, 0, "--motion"}, "holds no relative displacement of a connection of the model",
                         accepted + ", or mobile and fixed displacements");
    }
    return run;
}

void runPrescribedMotion(const SimulateOptions& options) {
    if (!options.report_file.empty())
        throw InputError({"", 0, "--report"}, "does not go with --motion",
                         "-o and --json; identify surface shows a recording with pictures");
    const MountModel model = readMountModel(options.model_file);
    OutputFiles outputs = beginOutputs(options, model);
    std::optional<ColumnMap> map;
    if (!options.column_map.empty()) map = readColumnMap(options.column_map);
    PrescribedRun run = followMotion(model, readRecording(options.motion_file, map ? &*map : nullptr));
    run.recording.metadata = {{"program", "wems simulate " WEMS_VERSION},
                              {"model", model.name + " (" + options.model_file + ")"},
                              {"excitation", "relative motion of " + options.motion_file}};
    std::vector<std::string> notes;
    if (!options.output_file.empty()) notes = writeRecording(run.recording, options.output_file, {}, outputs);
    Table table({"axis", "largest travel", "largest force", "energy put in"});
    nlohmann::json axes = nlohmann::json::array();
    for (const PrescribedAxis& axis : run.axes) {
        const std::string name = axis.connection + "." + "xyz"[axis.axis];
        table.addRow({name, formatNumber(1e3 * axis.largest_displacement, 4) + " mm",
                      formatNumber(axis.largest_force, 5) + " N", formatNumber(axis.energy_put_in, 4) + " J"});
        axes.push_back({{"axis", name},
                        {"largest_displacement", axis.largest_displacement},
                        {"largest_force", axis.largest_force},
                        {"energy_put_in", axis.energy_put_in}});
    }
    finishOutputs(options, {{"motion", options.motion_file}, {"axes", axes}}, table.format(styleOf(STDOUT_FILENO)),
                  outputs);
    for (const std::string& note : notes) std::cerr << "simulate: note: " << note << "\n";
}

}  // namespace wems::plugin
