// The report of response curves.
#include <algorithm>
#include <cmath>
#include <utility>

#include "models/format_number.hpp"
#include "models/report/html_report.hpp"
#include "models/text_table.hpp"
#include "plugin/response_command.hpp"

namespace wems::plugin {
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
