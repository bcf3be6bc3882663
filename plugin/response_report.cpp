// The report of response curves.
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/format_number.hpp"
#include "models/report/html_report.hpp"
#include "models/text_table.hpp"
#include "plugin/response_command.hpp"

namespace wems::plugin {
namespace {

/// The points of a curve for which `wanted` holds, with gaps where it does not; a point beside joins stretches.
template <class Wanted>
Series pick(const std::string& name, const ResponseCurve& curve, Eigen::Index axis, int color, const Wanted& wanted,
            bool joined) {
    Series series{name, {}, {}};
    series.color = color;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
        const ResponsePoint& point = curve.points[i];
        const bool beside = joined && i > 0 && wanted(curve.points[i - 1]);
        series.x.push_back(point.frequency);
        series.y.push_back(wanted(point) || beside ? 1e3 * point.amplitude[axis]
                                                   : std::numeric_limits<double>::quiet_NaN());
    }
    return series;
}

bool hasAny(const Series& series) {
    return std::any_of(series.y.begin(), series.y.end(), [](double y) { return std::isfinite(y); });
}

}  // namespace

void writeResponseReport(const MountModel& model, const std::vector<LevelResponse>& levels, const std::string& file) {
    const std::vector<std::string> axes = nameAxes(model);
    HtmlReport page("Periodic response of " + model.name);
    Table table({"level", "folds [Hz]", "unstable points", "stops touched", "points", "time [s]"});
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(axes.size()));
    std::size_t folded = 0;
    for (const LevelResponse& level : levels) {
        std::string folds;
        for (const ResponseFold& fold : level.curve.folds)
            folds += (folds.empty() ? "" : ", ") + formatNumber(fold.frequency, 5);
        folded += level.curve.folds.empty() ? 0 : 1;
        std::size_t unstable = 0;
        std::vector<bool> touched(nameStops(model).size(), false);
        for (const ResponsePoint& point : level.curve.points) {
            unstable += point.instability != Instability::none;
            largest = largest.cwiseMax(point.amplitude);
            for (std::size_t s = 0; s < touched.size(); ++s) touched[s] = touched[s] || point.penetration[s] > 0;
        }
        table.addRow({level.level, folds.empty() ? "none" : folds, std::to_string(unstable),
                      std::to_string(std::count(touched.begin(), touched.end(), true)),
                      std::to_string(level.curve.points.size()), formatNumber(level.curve.seconds, 2)});
    }
    page.addLead(folded == 0 ? "At no level does the response fold: one motion at each frequency on this branch."
                             : "At " + std::to_string(folded) + " of " + std::to_string(levels.size()) +
                                   " levels the response folds: sweeps up and down jump there.");
    page.addTable(table.header(), table.rows());
    page.addText(
        "Amplitude: half of what lies between the ends of the motion in a period. Points mark motions that are "
        "unstable, "
        "which no test shows; the second pictures mark where a stop is touched. Branches that are not connected with "
        "the low end "
        "of the band are not shown.");
    for (const LevelResponse& level : levels)
        if (!level.curve.incomplete.empty()) page.addText(level.level + ": " + level.curve.incomplete + ".");
    constexpr double worth_drawing = 0.02;  // of the largest amplitude of all axes
    const auto stable = [](const ResponsePoint& point) { return point.instability == Instability::none; };
    const auto unstable = [&](const ResponsePoint& point) { return !stable(point); };
    const auto touching = [](const ResponsePoint& point) { return point.touchesStop(); };
    for (Eigen::Index axis = 0; axis < largest.size(); ++axis) {
        if (largest[axis] < worth_drawing * largest.maxCoeff()) continue;
        Plot branches, contact;
        branches.title = "Relative displacement " + axes[static_cast<std::size_t>(axis)];
        contact.title = branches.title + ", where a stop is touched";
        for (Plot* plot : {&branches, &contact}) {
            plot->x_label = "frequency [Hz]";
            plot->y_label = "amplitude [mm]";
        }
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const auto color = static_cast<int>(i);
            const ResponseCurve& curve = levels[i].curve;
            branches.series.push_back(pick(levels[i].level, curve, axis, color, stable, true));
            Series marked = pick(levels[i].level + ", unstable", curve, axis, color, unstable, false);
            marked.points = true;
            if (hasAny(marked)) branches.series.push_back(std::move(marked));
            Series touched = pick(levels[i].level, curve, axis, color, touching, false);
            touched.points = true;
            if (hasAny(touched)) contact.series.push_back(std::move(touched));
        }
        page.addPlot(branches);
        if (!contact.series.empty()) page.addPlot(contact);
    }
    page.write(file);
}

}  // namespace wems::plugin
