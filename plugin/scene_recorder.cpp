#include "plugin/scene_recorder.hpp"

#include <algorithm>

namespace wems::plugin {
namespace {

constexpr Eigen::Index kStations = 80;  // some 0.5 MB of a report

}  // namespace

SceneRecorder::SceneRecorder(const MountModel& model, const Drive& drive, const SampleTimes& times,
                             std::vector<DrawnShape> drawing)
    : model_(model), drawing_(std::move(drawing)) {
    const auto count = static_cast<Eigen::Index>(times.size());
    const auto timeOf = [&](Eigen::Index k) { return times[k]; };
    const double interval = count > 1 ? times.back() / static_cast<double>(count - 1) : 1;
    std::vector<Eigen::Index> samples;
    run_.stations = placeStations(
        count, interval, std::min(kStations, count), timeOf,
        [&](Eigen::Index k) { return drive.calcFrequency(timeOf(k)); }, samples);
    for (std::size_t frame = 0; frame < samples.size(); ++frame) wanted_.emplace_back(samples[frame], frame);
    std::sort(wanted_.begin(), wanted_.end());
    const Eigen::Index frames = samples.size();
    run_.mobile = run_.fixed = Eigen::MatrixXd::Zero(6, frames);
    run_.force = Eigen::MatrixXd::Zero(3 * model.connections.size(), frames);
    run_.closed = Eigen::MatrixXi::Zero(findClosedStops(model, run_.force.col(0)).size(), frames);
}

void SceneRecorder::add(const DeviceMotion& motion) {
    for (; next_ < wanted_.size() && wanted_[next_].first == sample_; ++next_) {
        const Eigen::Index frame = wanted_[next_].second;
        run_.mobile.col(frame) = motion.mobile_pose;
        run_.fixed.col(frame) = motion.fixed_pose;
        run_.force.col(frame) = -motion.force.reshaped();
        Eigen::VectorXd q(run_.force.rows());
        for (std::size_t i = 0; i < motion.relative.size(); ++i) q.segment<3>(3 * i) = motion.relative[i].q;
        run_.closed.col(frame) = findClosedStops(model_, q);
    }
    ++sample_;
}

MotionScene SceneRecorder::finish(double time_offset, const Recording& recording) const {
    MotionScene scene;
    scene.title = "Simulated motion, exaggerated";
    scene.model = model_;
    scene.drawing = drawing_;
    scene.sensors = listSceneSensors(recording, model_);
    scene.runs = {run_};
    for (MotionStation& station : scene.runs.front().stations) station.time += time_offset;
    return scene;
}

}  // namespace wems::plugin
