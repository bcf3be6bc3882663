#include "models/report/motion_scene.hpp"

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

std::string formatScene(const MotionScene& scene) {
    std::string text = "{title:" + quoteScript(scene.title) +
                       ",cog:" + formatVector(scene.model.body.center_of_gravity) + "," +
                       formatConnections(scene.model) + ",runs:[";
    for (const SceneRun& run : scene.runs) text += formatRun(run) + ",";
    return text + "]}";
}

}  // namespace wems
