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
                " mm at " + axes[static_cast<std::size_t>(axis)] + ", " +
                formatNumber(curve.points[peak].frequency, 4) + " Hz; " + std::to_string(curve.points.size()) +
                " points, " + formatNumber(curve.seconds, 2) + " s\n";
        std::string folds;
        for (const ResponseFold& fold : curve.folds)
            folds += (folds.empty() ? "" : ", ") + formatNumber(fold.frequency, 5);
        text += "  folds: " + (folds.empty() ? "none" : folds + " Hz") + "\n";
        text += "  unstable: " +
                listStretches(
                    curve, [](const ResponsePoint& point) { return std::string(nameInstability(point.instability)); }) +
                "\n";
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

nlohmann::json makeResponseJson(const MountModel& model, const std::vector<LevelResponse>& levels) {
    auto list = nlohmann::json::array();
    for (const LevelResponse& level : levels) {
        auto points = nlohmann::json::array(), folds = nlohmann::json::array();
        for (const ResponsePoint& point : level.curve.points)
            points.push_back({{"frequency", point.frequency},
                              {"stable", point.instability == Instability::none},
                              {"instability", nameInstability(point.instability)},
                              {"largest_multiplier", point.largest_multiplier},
                              {"amplitude", listOf(point.amplitude)},
                              {"fundamental", listOf(point.first)},
                              {"highest", listOf(point.highest)},
                              {"lowest", listOf(point.lowest)},
                              {"penetration", point.penetration}});
        for (const ResponseFold& fold : level.curve.folds)
            folds.push_back({{"frequency", fold.frequency}, {"amplitude", listOf(fold.amplitude)}});
        list.push_back({{"level", level.level},
                        {"harmonics", level.curve.harmonics},
                        {"seconds", level.curve.seconds},
                        {"incomplete", level.curve.incomplete},
                        {"folds", folds},
                        {"points", points}});
    }
    return {{"levels", list},
            {"axes", nameAxes(model)},
            {"stops", nameStops(model)},
            {"units", {{"frequency", "Hz"}, {"amplitude", "m"}, {"penetration", "m"}, {"seconds", "s"}}}};
}

std::string formatResponseCsv(const MountModel& model, const std::vector<LevelResponse>& levels) {
    std::string text = "# model: " + model.name + "\nlevel,frequency [Hz],instability,largest_multiplier";
    for (const std::string& axis : nameAxes(model)) text += ",relative." + axis + " [m]";
    for (const std::string& stop : nameStops(model)) text += "," + stop + ".penetration [m]";
    text += "\n";
    for (const LevelResponse& level : levels)
        for (const ResponsePoint& point : level.curve.points) {
            text += "\"" + level.level + "\"," + formatNumber(point.frequency) + "," +
                    nameInstability(point.instability) + "," + formatNumber(point.largest_multiplier, 8);
            for (const double value : point.amplitude) text += "," + formatNumber(value, 8);
            for (const double value : point.penetration) text += "," + formatNumber(value, 8);
            text += "\n";
        }
    return text;
}

}  // namespace wems::plugin
