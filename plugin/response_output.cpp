// Text, JSON and CSV of response curves.
#include <algorithm>
#include <cmath>
#include <utility>

#include "models/common/format_number.hpp"
#include "models/common/text_table.hpp"
#include "models/report/html_report.hpp"
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

// The report of response curves.

namespace {

/// Size of a picture's axes, Hz and mm.
struct Frame {
    double width, height;
};

/// The curve, which goes to and fro, as closely spaced points where `wanted` holds at both ends of a stretch.
/// @param every so that other parts look thinner: one of so many points
template <class Wanted>
Series trace(const std::string& name, const ResponseCurve& curve, Eigen::Index axis, int color, const Frame& frame,
             int every, const Wanted& wanted) {
    constexpr double across = 900, up = 450;  // points, on the page
    Series series{name, {}, {}};
    series.color = color;
    series.points = true;
    int count = 0;
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
        const ResponsePoint &a = curve.points[i - 1], &b = curve.points[i];
        if (!wanted(a) || !wanted(b)) continue;
        const double dx = b.frequency - a.frequency, dy = 1e3 * (b.amplitude[axis] - a.amplitude[axis]);
        const double steps = std::ceil(std::max(std::abs(dx) / frame.width * across, std::abs(dy) / frame.height * up));
        for (double k = 0; k < steps; ++k) {
            if (count++ % every != 0) continue;
            series.x.push_back(a.frequency + dx * k / steps);
            series.y.push_back(1e3 * a.amplitude[axis] + dy * k / steps);
        }
    }
    return series;
}

}  // namespace

void writeResponseReport(const MountModel& model, const std::vector<LevelResponse>& levels, const std::string& file,
                         OutputFiles& outputs) {
    const std::vector<std::string> axes = nameAxes(model), stops = nameStops(model);
    HtmlReport page("Periodic response of " + model.name);
    Table table(
        {"level", "folds [Hz]", "detached curves [Hz]", "unstable points", "stops touched", "points", "time [s]"});
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(axes.size());
    std::size_t folded = 0, apart = 0;
    for (const LevelResponse& level : levels) {
        std::string folds;
        for (const ResponseFold& fold : level.curve.folds)
            folds += (folds.empty() ? "" : ", ") + formatNumber(fold.frequency, 5);
        folded += level.curve.folds.empty() ? 0 : 1;
        std::size_t unstable = 0;
        std::vector<bool> touched(stops.size(), false);
        for (const ResponsePoint& point : level.curve.points) {
            unstable += point.instability != Instability::none;
            largest = largest.cwiseMax(point.amplitude);
            for (std::size_t s = 0; s < touched.size(); ++s) touched[s] = touched[s] || point.penetration[s] > 0;
        }
        std::string detached;
        for (const ResponseCurve& other : level.curve.detached) {
            const auto [low, high] = std::minmax_element(
                other.points.begin(), other.points.end(),
                [](const ResponsePoint& a, const ResponsePoint& b) { return a.frequency < b.frequency; });
            detached += (detached.empty() ? "" : ", ") + formatNumber(low->frequency, 4) + " to " +
                        formatNumber(high->frequency, 4);
            for (const ResponsePoint& point : other.points) largest = largest.cwiseMax(point.amplitude);
        }
        apart += level.curve.detached.size();
        table.addRow({level.level, folds.empty() ? "none" : folds, detached.empty() ? "none found" : detached,
                      std::to_string(unstable), std::to_string(std::count(touched.begin(), touched.end(), true)),
                      std::to_string(level.curve.points.size()), formatNumber(level.curve.seconds, 2)});
    }
    page.addLead(folded == 0 ? "At no level does the response fold: one motion at each frequency on this branch."
                             : "At " + std::to_string(folded) + " of " + std::to_string(levels.size()) +
                                   " levels the response folds: sweeps up and down jump there.");
    if (apart > 0)
        page.addLead(std::to_string(apart) +
                     " detached curves were found: motions that no sweep from rest reaches, but a blow may.");
    page.addTable(table.header(), table.rows());
    page.addText(
        "Amplitude: half of what lies between the ends of the motion in a period. Sparse points mark motions that are "
        "unstable, which no test shows; further pictures mark where an axis touches its stops.");
    for (const LevelResponse& level : levels)
        if (!level.curve.incomplete.empty()) page.addText(level.level + ": " + level.curve.incomplete + ".");
    constexpr double worth_drawing = 0.02;  // of the largest amplitude of all axes
    const auto stable = [](const ResponsePoint& point) { return point.instability == Instability::none; };
    const auto unstable = [&](const ResponsePoint& point) { return !stable(point); };
    for (Eigen::Index axis = 0; axis < largest.size(); ++axis) {
        if (largest[axis] < worth_drawing * largest.maxCoeff()) continue;
        Plot branches, contact;
        branches.title = "Relative displacement " + axes[axis];
        contact.title = branches.title + ", where it touches a stop";
        std::vector<std::size_t> own;  // stops of this axis
        for (std::size_t s = 0; s < stops.size(); ++s)
            if (stops[s].rfind(axes[axis] + ".", 0) == 0) own.push_back(s);
        const auto touching = [&](const ResponsePoint& point) {
            return std::any_of(own.begin(), own.end(), [&](std::size_t s) { return point.penetration[s] > 0; });
        };
        for (Plot* plot : {&branches, &contact}) {
            plot->x_label = "frequency [Hz]";
            plot->y_label = "amplitude [mm]";
        }
        const ResponseCurve& any = levels.front().curve;
        const Frame frame{any.points.back().frequency - any.points.front().frequency, 1e3 * largest[axis]};
        constexpr int sparse = 6;
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const auto color = static_cast<int>(i);
            const ResponseCurve& curve = levels[i].curve;
            const std::string& name = levels[i].level;
            branches.series.push_back(trace(name, curve, axis, color, frame, 1, stable));
            for (auto& [plot, series] :
                 {std::pair{&branches, trace(name + ", unstable", curve, axis, color, frame, sparse, unstable)},
                  std::pair{&contact, trace(name, curve, axis, color, frame, 1, touching)}})
                if (!series.x.empty()) plot->series.push_back(series);
            for (std::size_t k = 0; k < curve.detached.size(); ++k) {
                const std::string own_name = name + ", detached " + std::to_string(k + 1);
                for (Series series :
                     {trace(own_name, curve.detached[k], axis, color, frame, 1, stable),
                      trace(own_name + ", unstable", curve.detached[k], axis, color, frame, sparse, unstable)})
                    if (!series.x.empty()) branches.series.push_back(std::move(series));
            }
        }
        page.addPlot(branches);
        if (!contact.series.empty()) page.addPlot(contact);
    }
    page.write(file, outputs);
}

}  // namespace wems::plugin
