#include "plugin/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "models/common/format_number.hpp"
#include "models/common/text_table.hpp"
#include "models/report/html_report.hpp"

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

namespace {

std::string formatFixed(double value, int decimals) {
    if (!std::isfinite(value)) return "-";
    char text[40];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

std::string nameAxis(const MountModel& model, int connection, int axis) {
    return model.connections[connection].name + "." + "xyz"[axis];
}

const Stop& findStop(const MountModel& model, const StopContact& contact) {
    return model.connections[contact.connection].axis[contact.axis].stops[contact.stop];
}

std::string nameStop(const MountModel& model, const StopContact& contact) {
    return nameAxis(model, contact.connection, contact.axis) +
           (findStop(model, contact).side == Side::positive ? ".+" : ".-");
}

Table makeStopTable(const RunDescription& run) {
    Table table({"stop reached", "from [Hz]", "to [Hz]", "from [s]", "to [s]", "deepest [mm]", "samples"});
    for (const StopContact& contact : run.result.contacts) {
        std::string name = nameStop(run.model, contact);
        for (const StopContact::Interval& interval : contact.intervals) {
            table.addRow({name, formatFixed(run.drive.calcFrequency(interval.first), 2),
                          formatFixed(run.drive.calcFrequency(interval.last), 2),
                          formatFixed(interval.first + run.time_offset, 3),
                          formatFixed(interval.last + run.time_offset, 3), formatFixed(1e3 * interval.deepest, 4),
                          std::to_string(interval.samples)});
            name.clear();
        }
    }
    return table;
}

Table makeDisplacementTable(const RunDescription& run) {
    Table table({"relative displacement", "largest [mm]", "at [Hz]", "at [s]"});
    for (const LargestDisplacement& largest : run.result.largest)
        table.addRow({nameAxis(run.model, largest.connection, largest.axis), formatFixed(1e3 * largest.value, 4),
                      formatFixed(run.drive.calcFrequency(largest.time), 2),
                      formatFixed(largest.time + run.time_offset, 3)});
    return table;
}

/// One value from end to end, as of a direction in which nothing acts.
bool isStill(const ThinnedChannel& channel) {
    return std::all_of(channel.values.begin(), channel.values.end(),
                       [&](double value) { return value == channel.values.front(); });
}

std::string describeCost(const SimulationCost& cost) {
    return formatNumber(cost.wall_time, 3) + " s wall, " + std::to_string(cost.steps) + " steps of " +
           std::to_string(cost.attempted_steps) + " attempted, " + std::to_string(cost.realizations) + " realizations";
}

nlohmann::json finiteOrNull(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace

std::string formatSummary(const RunDescription& run, TextStyle style) {
    const Table stops = makeStopTable(run);
    return (stops.empty() ? std::string("no stop reached\n") : stops.format(style)) + "\n" +
           makeDisplacementTable(run).format(style) + "\n" + describeCost(run.result.cost) + "\n";
}

nlohmann::json makeSummaryJson(const RunDescription& run) {
    nlohmann::json stops = nlohmann::json::array(), displacements = nlohmann::json::array();
    for (const StopContact& contact : run.result.contacts) {
        nlohmann::json intervals = nlohmann::json::array();
        for (const StopContact::Interval& interval : contact.intervals)
            intervals.push_back({{"first_time", interval.first + run.time_offset},
                                 {"last_time", interval.last + run.time_offset},
                                 {"first_frequency", finiteOrNull(run.drive.calcFrequency(interval.first))},
                                 {"last_frequency", finiteOrNull(run.drive.calcFrequency(interval.last))},
                                 {"deepest", interval.deepest},
                                 {"samples", interval.samples}});
        stops.push_back({{"name", nameStop(run.model, contact)}, {"contacts", intervals}});
    }
    for (const LargestDisplacement& largest : run.result.largest)
        displacements.push_back({{"name", nameAxis(run.model, largest.connection, largest.axis)},
                                 {"largest", largest.value},
                                 {"time", largest.time + run.time_offset},
                                 {"frequency", finiteOrNull(run.drive.calcFrequency(largest.time))}});
    return {{"stops", stops},
            {"relative_displacements", displacements},
            {"samples", run.result.samples},
            {"cost",
             {{"wall_time", run.result.cost.wall_time},
              {"steps", run.result.cost.steps},
              {"attempted_steps", run.result.cost.attempted_steps},
              {"realizations", run.result.cost.realizations}}}};
}

void writeHtmlSummary(const RunDescription& run, const Recording& header, const RunOverview& overview,
                      const ConnectionOverview& connections, const SceneRecorder& scene, const std::string& file,
                      OutputFiles& outputs) {
    HtmlReport report("Simulation of " + run.model.name);
    report.addLead(connections.makeHeadline(run.drive));
    std::vector<std::string> settings;
    for (const auto& [key, value] : header.metadata) settings.push_back(key + ": " + value);
    report.addList(settings);
    const Table stops = makeStopTable(run), margins = connections.makeTable(run.drive);
    report.addHeading("Stops");
    if (stops.empty()) {
        report.addText("No stop was reached.");
    } else {
        report.addTable(stops.header(), stops.rows());
    }
    report.addHeading("Connections: displacement, force, clearance left");
    report.addTable(margins.header(), margins.rows());
    connections.addPictures(report, run.drive, run.time_offset);
    report.addHeading("The device in motion");
    report.addText(
        "The motion is exaggerated about the rest position, clearances alike, so that a stop touches in the picture "
        "when "
        "it does in the run. Arrows are the forces of the connections on the mobile part. Drag to turn the view.");
    report.addScene(scene.finish(run.time_offset, header));
    report.addHeading("Channels");

    // Against frequency where it sweeps, against time otherwise.
    const bool swept = isSwept(run.drive);
    for (const Part part : {Part::mobile, Part::fixed}) {
        for (const Derivative derivative : {Derivative::displacement, Derivative::acceleration}) {
            for (int axis = 0; axis < 3; ++axis) {
                const std::string side = part == Part::mobile ? "Mobile part, " : "Fixed part, ";
                const bool displacement = derivative == Derivative::displacement;
                Plot plot;
                plot.title = side + (displacement ? "displacement " : "acceleration ") + "xyz"[axis];
                plot.x_label = swept ? "swept frequency [Hz]" : "time [s]";
                plot.y_label = displacement ? "displacement [mm]" : "acceleration [m/s^2]";
                for (const Connection& connection : run.model.connections) {
                    const ThinnedChannel* channel =
                        overview.find(formatChannelName({part, connection.name, axis, derivative}));
                    if (channel == nullptr || isStill(*channel)) continue;
                    Series series{connection.name, channel->time, channel->values};
                    for (double& value : series.y) value *= displacement ? 1e3 : 1;
                    if (swept)
                        for (double& x : series.x) x = run.drive.calcFrequency(x - run.time_offset);
                    plot.series.push_back(std::move(series));
                }
                if (!plot.series.empty()) report.addPlot(plot);
            }
        }
    }
    report.addText(describeCost(run.result.cost));
    report.write(file, outputs);
}

}  // namespace wems::plugin
