#include "identify/commands/device_scene.hpp"

#include <algorithm>
#include <cmath>

#include "identify/fit/law_history.hpp"
#include "identify/motion/swept_frequency.hpp"

namespace wems::identify::commands {
namespace {

constexpr Eigen::Index all_stations = 240;                         // of all runs together, so that the page stays small
constexpr Eigen::Index fewest_stations = 10, most_stations = 120;  // of each run
constexpr Eigen::Index frames_per_station = 48;
constexpr double periods_per_station = 2;
constexpr double window_without_sine = 0.2;  // s

/// Swept frequency (Hz) at a time; NaN where there is none.
double findHertz(const Recording& recording, const SweptFrequency& swept, double time) {
    if (!swept.is_sine) return NAN;
    const auto next = std::lower_bound(recording.time.begin(), recording.time.end(), time);
    const auto sample = std::min<std::ptrdiff_t>(next - recording.time.begin(), swept.hertz.size() - 1);
    return swept.hertz(sample);
}

/// Stations at equal times; neighbours may overlap in a short run.
std::vector<MotionStation> placeStations(const RunMotion& run, const Recording& recording, Eigen::Index wanted,
                                         std::vector<Eigen::Index>& samples) {
    const SweptFrequency swept = findSweptFrequency(recording);
    const auto available = static_cast<Eigen::Index>(run.time.size());
    std::vector<MotionStation> stations;
    for (Eigen::Index s = 0; s < wanted; ++s) {
        const Eigen::Index middle = (2 * s + 1) * available / (2 * wanted);
        MotionStation station;
        station.hertz = findHertz(recording, swept, run.time[middle]);
        const double window = station.hertz > 0 ? periods_per_station / station.hertz : window_without_sine;
        const auto length = std::clamp<Eigen::Index>(std::lround(window / run.interval), 1, available);
        const Eigen::Index stride = std::max<Eigen::Index>(1, length / frames_per_station);
        const Eigen::Index first = std::clamp<Eigen::Index>(middle - length / 2, 0, available - length);
        station.time = run.time[first];
        station.period = static_cast<double>(stride) * run.interval;
        station.from = static_cast<Eigen::Index>(samples.size());
        for (Eigen::Index k = first; k < first + length; k += stride) samples.push_back(k);
        station.count = static_cast<Eigen::Index>(samples.size()) - station.from;
        stations.push_back(station);
    }
    return stations;
}

Eigen::MatrixXd pickPose(const PartMotion& part, const std::vector<Eigen::Index>& samples) {
    Eigen::MatrixXd pose(6, samples.size());
    Eigen::Index frame = 0;
    for (const Eigen::Index k : samples) {
        pose.col(frame).head<3>() = part.p.col(k);
        pose.col(frame++).tail<3>() = part.theta.col(k);
    }
    return pose;
}

bool isClosed(const AxisLaw& law, const Stop& stop, double q) {
    return (stop.side == Side::positive ? 1 : -1) * (q + law.offset) > stop.clearance;
}

SceneRun makeRun(const RunMotion& run, const Recording& recording, const MountModel& model, Eigen::Index wanted) {
    SceneRun scene;
    scene.name = run.file;
    std::vector<Eigen::Index> samples;
    scene.stations = placeStations(run, recording, wanted, samples);
    scene.mobile = pickPose(run.mobile, samples);
    scene.fixed = pickPose(run.fixed, samples);

    const RelativeHistory relative = calcRelativeHistory(run, model);
    const RowMatrix force = calcForceHistory(model, relative, run.time);
    std::vector<std::pair<Eigen::Index, const Stop*>> stops;  // column of q
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const Stop& stop : model.connections[i].axis[axis].stops) stops.emplace_back(3 * i + axis, &stop);
    scene.force.resize(force.cols(), samples.size());
    scene.closed.resize(stops.size(), scene.force.cols());
    for (Eigen::Index frame = 0; frame < scene.force.cols(); ++frame) {
        const Eigen::Index k = samples[frame];
        scene.force.col(frame) = -force.row(k).transpose();
        for (std::size_t s = 0; s < stops.size(); ++s) {
            const auto [column, stop] = stops[s];
            const AxisLaw& law = model.connections[column / 3].axis[column % 3];
            scene.closed(s, frame) = isClosed(law, *stop, relative.q(k, column)) ? 1 : 0;
        }
    }
    return scene;
}

}  // namespace

MotionScene makeDeviceScene(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings,
                            const MountModel& model) {
    MotionScene scene;
    scene.title = "Recorded motion, exaggerated";
    scene.model = model;
    if (runs.empty()) return scene;
    const auto wanted =
        std::clamp(all_stations / static_cast<Eigen::Index>(runs.size()), fewest_stations, most_stations);
    for (std::size_t r = 0; r < runs.size(); ++r) scene.runs.push_back(makeRun(runs[r], recordings[r], model, wanted));
    return scene;
}

MotionScene makeDeviceScene(const std::vector<Recording>& recordings, const MountModel& model) {
    std::vector<RunMotion> runs;
    for (const Recording& recording : recordings) runs.push_back(estimateMotion(recording, model));
    return makeDeviceScene(runs, recordings, model);
}

void addMotion(HtmlReport& page, const MotionScene& scene) {
    page.addHeading("The device in motion");
    page.addText(
        "The recorded motion, exaggerated about the rest position; clearances are exaggerated alike, so that a stop "
        "touches in the picture when it does in the run. At each place along the run a short stretch of the motion is "
        "played slowly. Arrows are the forces that the model's laws give along this motion. Drag to turn the view.");
    page.addScene(scene);
}

}  // namespace wems::identify::commands
