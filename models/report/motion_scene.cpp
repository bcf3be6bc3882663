#include "models/report/motion_scene.hpp"

#include <algorithm>
#include <cmath>

#include "models/report/html_text.hpp"

namespace wems {
namespace {

std::string formatVector(const Eigen::Vector3d& v) {
    return "[" + formatScriptNumber(v.x()) + "," + formatScriptNumber(v.y()) + "," + formatScriptNumber(v.z()) + "]";
}

/// `{unit: 1e-7, rows: 3, values: [integers, column by column]}`: an integer times the unit is the value.
std::string formatRows(const Eigen::Ref<const Eigen::MatrixXd>& values) {
    constexpr double steps = 9999;
    const double largest = values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0;
    const double unit = largest > 0 ? largest / steps : 1;
    std::string text = "{unit:" + formatScriptNumber(unit) + ",rows:" + std::to_string(values.rows()) + ",values:[";
    for (Eigen::Index column = 0; column < values.cols(); ++column)
        for (Eigen::Index row = 0; row < values.rows(); ++row)
            text += std::to_string(std::lround(values(row, column) / unit)) + ",";
    return text + "]}";
}

std::string formatConnections(const MountModel& model) {
    std::string connections = "[", stops = "[";
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        const Connection& connection = model.connections[i];
        connections += "{name:" + quoteScript(connection.name) + ",at:" + formatVector(connection.position) + "},";
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const Stop& stop : connection.axis[axis].stops) {
                const bool positive = stop.side == Side::positive;
                const std::string name = connection.name + "." + "xyz"[axis] + (positive ? ".+" : ".-");
                const double gap = stop.clearance - (positive ? 1 : -1) * connection.axis[axis].offset;
                stops += "{name:" + quoteScript(name) + ",connection:" + std::to_string(i) +
                         ",axis:" + std::to_string(axis) + ",side:" + (positive ? "1" : "-1") +
                         ",gap:" + formatScriptNumber(gap) + "},";
            }
    }
    return "connections:" + connections + "],stops:" + stops + "]";
}

std::string namePart(Part part) {
    return part == Part::mobile ? "mobile" : "fixed";
}

std::string formatShape(const DrawnShape& shape) {
    std::string text = "{part:\"" + namePart(shape.part) + "\",kind:\"" + nameShape(shape.kind) +
                       "\",size:" + formatVector(shape.size) + ",at:" + formatVector(shape.position) +
                       ",theta:" + formatVector(shape.rotation);
    if (shape.kind == DrawnShape::Kind::stl) text += ",corners:" + formatRows(shape.scale * readStl(shape.path));
    return text + "},";
}

std::string formatRun(const SceneRun& run) {
    std::string stations, closed;
    for (const MotionStation& station : run.stations)
        stations += "{hertz:" + formatScriptNumber(station.hertz) + ",time:" + formatScriptNumber(station.time) +
                    ",period:" + formatScriptNumber(station.period) + ",from:" + std::to_string(station.from) +
                    ",count:" + std::to_string(station.count) + "},";
    for (Eigen::Index frame = 0; frame < run.closed.cols(); ++frame) {
        closed += '"';
        for (Eigen::Index stop = 0; stop < run.closed.rows(); ++stop)
            closed += run.closed(stop, frame) != 0 ? '1' : '0';
        closed += "\",";
    }
    const auto formatPart = [](const Eigen::MatrixXd& pose) {
        return "{p:" + formatRows(pose.topRows(3)) + ",theta:" + formatRows(pose.bottomRows(3)) + "}";
    };
    return "{name:" + quoteScript(run.name) + ",stations:[" + stations + "],mobile:" + formatPart(run.mobile) +
           ",fixed:" + formatPart(run.fixed) + ",force:" + formatRows(run.force) + ",closed:[" + closed + "]}";
}

}  // namespace

std::vector<MotionStation> placeStations(Eigen::Index count, double interval, Eigen::Index wanted,
                                         const std::function<double(Eigen::Index)>& time,
                                         const std::function<double(Eigen::Index)>& hertz,
                                         std::vector<Eigen::Index>& samples) {
    constexpr Eigen::Index frames_per_station = 48;
    constexpr double periods_per_station = 2;
    constexpr double window_without_sine = 0.2;  // s
    std::vector<MotionStation> stations;
    for (Eigen::Index s = 0; s < wanted; ++s) {
        const Eigen::Index middle = (2 * s + 1) * count / (2 * wanted);
        MotionStation station;
        station.hertz = hertz(middle);
        const double window = station.hertz > 0 ? periods_per_station / station.hertz : window_without_sine;
        const auto length = std::clamp<Eigen::Index>(std::lround(window / interval), 1, count);
        const Eigen::Index stride = std::max<Eigen::Index>(1, length / frames_per_station);
        const Eigen::Index first = std::clamp<Eigen::Index>(middle - length / 2, 0, count - length);
        station.time = time(first);
        station.period = static_cast<double>(stride) * interval;
        station.from = static_cast<Eigen::Index>(samples.size());
        for (Eigen::Index k = first; k < first + length; k += stride) samples.push_back(k);
        station.count = static_cast<Eigen::Index>(samples.size()) - station.from;
        stations.push_back(station);
    }
    return stations;
}

Eigen::VectorXi findClosedStops(const MountModel& model, const Eigen::Ref<const Eigen::VectorXd>& q) {
    std::vector<int> closed;
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const AxisLaw& law = model.connections[i].axis[axis];
            for (const Stop& stop : law.stops)
                closed.push_back(
                    (stop.side == Side::positive ? 1 : -1) * (q[3 * i + axis] + law.offset) > stop.clearance ? 1 : 0);
        }
    return Eigen::Map<const Eigen::VectorXi>(closed.data(), closed.size());
}

std::vector<SceneSensor> listSceneSensors(const Recording& recording, const MountModel& model) {
    std::vector<SceneSensor> sensors;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || (name->part != Part::mobile && name->part != Part::fixed)) continue;
        SceneSensor sensor{namePart(name->part) + "." + name->connection, name->part, {}};
        const bool known = std::any_of(sensors.begin(), sensors.end(),
                                       [&](const SceneSensor& other) { return other.name == sensor.name; });
        if (known) continue;
        const int place = model.placeIndex(*name);
        const auto at = std::find_if(model.connections.begin(), model.connections.end(),
                                     [&](const Connection& own) { return own.name == name->connection; });
        if (place < 0 && at == model.connections.end()) continue;
        sensor.position = place >= 0 ? model.places[place].position : at->position;
        sensors.push_back(std::move(sensor));
    }
    return sensors;
}

std::string formatScene(const MotionScene& scene) {
    std::string text = "{title:" + quoteScript(scene.title) +
                       ",cog:" + formatVector(scene.model.body.center_of_gravity) + "," +
                       formatConnections(scene.model) + ",shapes:[";
    for (const DrawnShape& shape : scene.drawing) text += formatShape(shape);
    text += "],sensors:[";
    for (const SceneSensor& sensor : scene.sensors)
        text += "{name:" + quoteScript(sensor.name) + ",part:\"" + namePart(sensor.part) +
                "\",at:" + formatVector(sensor.position) + "},";
    text += "],runs:[";
    for (const SceneRun& run : scene.runs) text += formatRun(run) + ",";
    return text + "]}";
}

}  // namespace wems
