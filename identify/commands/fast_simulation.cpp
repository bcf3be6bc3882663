#include "identify/commands/fast_simulation.hpp"

#include <optional>

#include "identify/commands/recordings.hpp"
#include "identify/forward/drive.hpp"
#include "identify/forward/forward_model.hpp"
#include "identify/forward/simulated_recording.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify::commands {
namespace {

/// Rows `first + x` … of a recording; empty if it has none of them.
Eigen::Matrix3Xd takeVector(const Recording& recording, const std::string& first) {
    Eigen::Matrix3Xd rows;
    for (int axis = 0; axis < 3; ++axis) {
        const Channel* channel = recording.find(first + kAxes[axis]);
        if (channel == nullptr) continue;
        if (rows.cols() == 0) rows.setZero(3, recording.sampleCount());
        rows.row(axis) = Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), rows.cols());
    }
    return rows;
}

void addPart(Recording& recording, const MountModel& model, const std::string& side, const Eigen::MatrixXd& rows,
             const std::string& derivative, const std::string& unit) {
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            Channel channel;
            channel.name = side + "." + model.connections[i].name + "." + derivative + kAxes[axis];
            channel.unit = unit;
            const Eigen::VectorXd values = rows.row(static_cast<Eigen::Index>(3 * i) + axis).transpose();
            channel.values.assign(values.begin(), values.end());
            recording.channels.push_back(std::move(channel));
        }
}

Recording simulateLoaded(const MountModel& model, const Recording& drive, const Eigen::Matrix3Xd& load,
                         const Eigen::Matrix3Xd& base) {
    RunMotion run;
    run.time = drive.time;
    run.interval = drive.sampleInterval();
    const ForwardModel forward(model);
    const Drive driven = Drive::makeLoad(run.time, load, base, makeGrid(run, model));
    const MarkerMotion markers = forward.calcMarkers(forward.simulate(driven, Keep::states), driven);
    Recording recording;
    recording.time = drive.time;
    addPart(recording, model, "mobile", markers.mobile_displacement, "", "m");
    addPart(recording, model, "fixed", markers.fixed_displacement, "", "m");
    addPart(recording, model, "mobile", markers.mobile_acceleration, "a", "m/s^2");
    addPart(recording, model, "fixed", markers.fixed_acceleration, "a", "m/s^2");
    for (const Channel& channel : drive.channels)
        if (channel.name.rfind("load.", 0) == 0 || channel.name.rfind("base.", 0) == 0)
            recording.channels.push_back(channel);
    return recording;
}

}  // namespace

Recording runFastSimulation(const FastSimulationRequest& request, Watcher& watcher) {
    const MountModel model = readDeviceModel(request.model, "");
    const std::optional<ColumnMap> map = readDeviceMap(request.columns, model);
    watcher.onStep({"reading " + request.drive.file});
    const Recording drive = readSource(request.drive, map ? &*map : nullptr);
    watcher.onStep({"fast forward simulation", 0.1, 1});
    const Eigen::Matrix3Xd load = takeVector(drive, "load.f"), base = takeVector(drive, "base.a");
    const bool on_mobile = model.load_point && model.load_point->part == Part::mobile;
    Recording simulated;
    if ((load.cols() > 0 && !on_mobile && !model.bracket.empty()) || base.cols() > 0) {
        simulated = simulateLoaded(model, drive, load, base);
    } else if (!drive.connections(Part::fixed).empty()) {
        SimulatedNoise none;
        none.sign = 0;
        simulated = simulateRecording(estimateMotion(drive, model), model, none);
    } else {
        throw InputError({request.drive.file, 0, ""}, "drives nothing",
                         "load.f* on a bracket, base.a*, or the motion of the fixed part");
    }
    simulated.file = "fast simulation of " + request.drive.file;
    simulated.format = "simulation";
    return simulated;
}

}  // namespace wems::identify::commands
