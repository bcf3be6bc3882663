// Text, JSON and CSV of response curves.
#include <algorithm>

#include "models/format_number.hpp"
#include "models/text_table.hpp"
#include "plugin/response_command.hpp"

namespace wems::plugin {
namespace {

/// Stretches of a curve on which something holds, as `29.1 to 36.7 Hz`, with a text for each.
template <class Label>
std::string listStretches(const ResponseCurve& curve, const Label& label) {
    std::string text;
    for (std::size_t i = 0; i < curve.points.size();) {
        const std::string name = label(curve.points[i]);
        std::size_t end = i;
        double lowest = curve.points[i].frequency, highest = lowest;
        for (; end < curve.points.size() && label(curve.points[end]) == name; ++end) {
            lowest = std::min(lowest, curve.points[end].frequency);
            highest = std::max(highest, curve.points[end].frequency);
        }
        if (!name.empty())
            text += (text.empty() ? "" : "; ") + formatNumber(lowest, 4) + " to " + formatNumber(highest, 4) + " Hz" +
                    (name == "-" ? "" : " (" + name + ")");
        i = end;
    }
    return text.empty() ? "none" : text;
}

Eigen::Index findLargest(const ResponseCurve& curve, std::size_t& point) {
    double largest = -1;
    Eigen::Index axis = 0;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
        Eigen::Index at = 0;
        if (const double value = curve.points[i].amplitude.maxCoeff(&at); value > largest) {
            largest = value;
            axis = at;
            point = i;
        }
    }
    return axis;
}

std::string describeInstability(const ResponseCurve& curve) {
    return listStretches(curve,
                         [](const ResponsePoint& point) { return std::string(nameInstability(point.instability)); });
}

/// One line for each detached curve.
std::string describeDetached(const ResponseCurve& curve, const std::vector<std::string>& axes) {
    if (curve.detached.empty()) return "  detached: none found\n";
    std::string text;
    for (const ResponseCurve& other : curve.detached) {
        std::size_t peak = 0;
        const Eigen::Index axis = findLargest(other, peak);
        text += "  detached: " + listStretches(other, [](const ResponsePoint&) { return std::string("-"); }) +
                ", largest amplitude " + formatNumber(1e3 * other.points[peak].amplitude[axis], 4) + " mm at " +
                axes[axis] + "; unstable: " + describeInstability(other) + "\n";
        if (!other.incomplete.empty()) text += "note: " + other.incomplete + "\n";
    }
    return text;
}

nlohmann::json listOf(const Eigen::VectorXd& values) {
    return std::vector<double>(values.begin(), values.end());
}

}  // namespace

std::string formatResponses(const MountModel& model, const std::vector<LevelResponse>& levels, TextStyle style) {
    const std::vector<std::string> axes = nameAxes(model), stops = nameStops(model);
    std::string text;
    for (const LevelResponse& level : levels) {
        const ResponseCurve& curve = level.curve;
        if (!text.empty()) text += "\n";
        std::size_t peak = 0;
        const Eigen::Index axis = findLargest(curve, peak);
        text += level.level + ": largest amplitude " + formatNumber(1e3 * curve.points[peak].amplitude[axis], 4) +
                " mm at " + axes[axis] + ", " + formatNumber(curve.points[peak].frequency, 4) + " Hz; " +
                std::to_string(curve.points.size()) + " points, " + formatNumber(curve.seconds, 2) + " s\n";
        std::string folds;
        for (const ResponseFold& fold : curve.folds)
            folds += (folds.empty() ? "" : ", ") + formatNumber(fold.frequency, 5);
        text += "  folds: " + (folds.empty() ? "none" : folds + " Hz") + "\n";
        text += "  unstable: " + describeInstability(curve) + "\n";
        text += describeDetached(curve, axes);
        Table contacts({"stop touched", "from [Hz]", "to [Hz]", "deepest [mm]"});
        for (std::size_t s = 0; s < stops.size(); ++s) {
            double lowest = 0, highest = 0, deepest = 0;
            for (const ResponsePoint& point : curve.points) {
                if (!(point.penetration[s] > 0)) continue;
                lowest = deepest > 0 ? std::min(lowest, point.frequency) : point.frequency;
                highest = std::max(highest, point.frequency);
                deepest = std::max(deepest, point.penetration[s]);
            }
            if (deepest > 0)
                contacts.addRow(
                    {stops[s], formatNumber(lowest, 4), formatNumber(highest, 4), formatNumber(1e3 * deepest, 4)});
        }
        text += contacts.empty() ? std::string("  no stop touched\n") : contacts.format(style);
        if (!curve.incomplete.empty()) text += "note: " + curve.incomplete + "\n";
    }
    return text;
}

namespace {

nlohmann::json makeCurveJson(const ResponseCurve& curve) {
    auto points = nlohmann::json::array(), folds = points, bifurcations = points;
    for (const ResponsePoint& point : curve.points)
        points.push_back({{"frequency", point.frequency},
                          {"stable", point.instability == Instability::none},
                          {"instability", nameInstability(point.instability)},
                          {"largest_multiplier", point.largest_multiplier},
                          {"amplitude", listOf(point.amplitude)},
                          {"fundamental", listOf(point.first)},
                          {"highest", listOf(point.highest)},
                          {"lowest", listOf(point.lowest)},
                          {"penetration", point.penetration}});
    for (const ResponseFold& fold : curve.folds)
        folds.push_back({{"frequency", fold.frequency}, {"amplitude", listOf(fold.amplitude)}});
    for (const ResponseBifurcation& change : curve.bifurcations)
        bifurcations.push_back({{"frequency", change.frequency}, {"kind", nameInstability(change.kind)}});
    return {{"incomplete", curve.incomplete}, {"folds", folds}, {"bifurcations", bifurcations}, {"points", points}};
}

}  // namespace

nlohmann::json makeResponseJson(const MountModel& model, const std::vector<LevelResponse>& levels) {
    auto list = nlohmann::json::array();
    for (const LevelResponse& level : levels) {
        nlohmann::json entry = makeCurveJson(level.curve);
        entry["level"] = level.level;
        entry["harmonics"] = level.curve.harmonics;
        entry["seconds"] = level.curve.seconds;
        entry["detached"] = nlohmann::json::array();
        for (const ResponseCurve& other : level.curve.detached) entry["detached"].push_back(makeCurveJson(other));
        list.push_back(std::move(entry));
    }
    return {{"levels", list},
            {"axes", nameAxes(model)},
            {"stops", nameStops(model)},
            {"units", {{"frequency", "Hz"}, {"amplitude", "m"}, {"penetration", "m"}, {"seconds", "s"}}}};
}

std::string formatResponseCsv(const MountModel& model, const std::vector<LevelResponse>& levels) {
    std::string text = "# model: " + model.name + "\nlevel,curve,frequency [Hz],instability,largest_multiplier";
    for (const std::string& axis : nameAxes(model)) text += ",relative." + axis + " [m]";
    for (const std::string& stop : nameStops(model)) text += "," + stop + ".penetration [m]";
    text += "\n";
    const auto addCurve = [&text](const std::string& level, const std::string& name, const ResponseCurve& curve) {
        for (const ResponsePoint& point : curve.points) {
            text += "\"" + level + "\"," + name + "," + formatNumber(point.frequency) + "," +
                    nameInstability(point.instability) + "," + formatNumber(point.largest_multiplier, 8);
            for (const double value : point.amplitude) text += "," + formatNumber(value, 8);
            for (const double value : point.penetration) text += "," + formatNumber(value, 8);
            text += "\n";
        }
    };
    for (const LevelResponse& level : levels) {
        addCurve(level.level, "main", level.curve);
        for (std::size_t i = 0; i < level.curve.detached.size(); ++i)
            addCurve(level.level, "detached " + std::to_string(i + 1), level.curve.detached[i]);
    }
    return text;
}

}  // namespace wems::plugin
