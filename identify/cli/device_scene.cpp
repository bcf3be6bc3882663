#include "identify/cli/device_scene.hpp"

#include <algorithm>
#include <cmath>

#include "identify/fit/law_history.hpp"
#include "identify/motion/swept_frequency.hpp"

namespace wems::identify::cli {
namespace {

constexpr Eigen::Index all_stations = 240;                         // of all runs together, so that the page stays small
constexpr Eigen::Index fewest_stations = 10, most_stations = 120;  // of each run

/// Swept frequency (Hz) at a time; NaN where there is none.
double findHertz(const Recording& recording, const SweptFrequency& swept, double time) {
    if (!swept.is_sine) return NAN;
    const auto next = std::lower_bound(recording.time.begin(), recording.time.end(), time);
    const auto sample = std::min<std::ptrdiff_t>(next - recording.time.begin(), swept.hertz.size() - 1);
    return swept.hertz(sample);
}

Eigen::MatrixXd pickPose(const PartMotion& part, const std::vector<Eigen::Index>& samples) {
    Eigen::MatrixXd pose(6, static_cast<Eigen::Index>(samples.size()));
    Eigen::Index frame = 0;
    for (const Eigen::Index k : samples) {
        pose.col(frame).head<3>() = part.p.col(k);
        pose.col(frame++).tail<3>() = part.theta.col(k);
    }
    return pose;
}

SceneRun makeRun(const RunMotion& run, const Recording& recording, const MountModel& model, Eigen::Index wanted) {
    SceneRun scene;
    scene.name = run.file;
    std::vector<Eigen::Index> samples;
    const SweptFrequency swept = findSweptFrequency(recording);
    const auto timeOf = [&](Eigen::Index k) { return run.time[static_cast<std::size_t>(k)]; };
    scene.stations = placeStations(
        static_cast<Eigen::Index>(run.time.size()), run.interval, wanted, timeOf,
        [&](Eigen::Index k) { return findHertz(recording, swept, timeOf(k)); }, samples);
    scene.mobile = pickPose(run.mobile, samples);
    scene.fixed = pickPose(run.fixed, samples);

    const RelativeHistory relative = calcRelativeHistory(run, model);
    const RowMatrix force = calcForceHistory(model, relative, run.time);
    scene.force.resize(force.cols(), static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index frame = 0; frame < scene.force.cols(); ++frame) {
        const Eigen::Index k = samples[static_cast<std::size_t>(frame)];
        scene.force.col(frame) = -force.row(k).transpose();
        const Eigen::VectorXi closed = findClosedStops(model, relative.q.row(k).transpose());
        scene.closed.conservativeResize(closed.size(), scene.force.cols());
        scene.closed.col(frame) = closed;
    }
    return scene;
}

}  // namespace

MotionScene makeDeviceScene(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings,
                            const MountModel& model, const std::vector<DrawnShape>& drawing) {
    MotionScene scene;
    scene.drawing = drawing;
    scene.title = "Recorded motion, exaggerated";
    scene.model = model;
    if (runs.empty()) return scene;
    scene.sensors = listSceneSensors(recordings.front(), model);
    const auto wanted =
        std::clamp(all_stations / static_cast<Eigen::Index>(runs.size()), fewest_stations, most_stations);
    for (std::size_t r = 0; r < runs.size(); ++r) scene.runs.push_back(makeRun(runs[r], recordings[r], model, wanted));
    return scene;
}

MotionScene makeDeviceScene(const std::vector<Recording>& recordings, const MountModel& model,
                            const std::vector<DrawnShape>& drawing) {
    std::vector<RunMotion> runs;
    for (const Recording& recording : recordings) runs.push_back(estimateMotion(recording, model));
    return makeDeviceScene(runs, recordings, model, drawing);
}

void addMotion(HtmlReport& page, const MotionScene& scene) {
    page.addHeading("The device in motion");
    page.addText(
        "The recorded motion, exaggerated about the rest position; clearances are exaggerated alike, so that a stop "
        "touches in the picture when it does in the run. At each place along the run a short stretch of the motion is "
        "played slowly. Arrows are the forces that the model's laws give along this motion. Drag to turn the view.");
    page.addScene(scene);
}

}  // namespace wems::identify::cli
