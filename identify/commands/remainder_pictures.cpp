#include "identify/commands/remainder_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/commands/judged_runs.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/format_number.hpp"

namespace wems::identify::commands {
namespace {

constexpr int kSegment = 512;         // of the spectra, samples
constexpr double kShownLag = 0.2;     // s, of the autocorrelation …
constexpr double kShownOverlaps = 4;  // … and at least
constexpr Eigen::Index kFewest = 64;  // outputs, for spectra and autocorrelation

struct WrenchPart {
    const char *name, *unit, *density_unit;
    int first;  // row
};
constexpr WrenchPart kParts[] = {{"force", "N", "N/√Hz", 0}, {"moment", "N m", "N m/√Hz", 3}};

std::vector<double> listTimes(const RunRemainder& run) {
    std::vector<double> times(run.unexplained.cols());
    for (std::size_t n = 0; n < times.size(); ++n) times[n] = run.start + static_cast<double>(n) * run.interval;
    return times;
}

Plot plotTime(const RunRemainder& run, const WrenchPart& part) {
    Plot plot{std::string("Unexplained ") + part.name, "time [s]", std::string(part.name) + " [" + part.unit + "]", {}};
    const std::vector<double> times = listTimes(run);
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd row = run.unexplained.row(part.first + axis).transpose();
        plot.series.push_back({std::string(1, "xyz"[axis]), times, {row.begin(), row.end()}});
    }
    return plot;
}

/// Of the vector's length: the root of the axes' summed densities.
Series makeSpectrum(const std::string& name, const Eigen::Matrix<double, 6, Eigen::Dynamic>& wrench,
                    const RunRemainder& run, int first, int color) {
    Series series{name, {}, {}, false, color};
    Eigen::VectorXd sum;
    for (int axis = 0; axis < 3; ++axis) {
        const Spectrum spectrum = calcSpectrum(wrench.row(first + axis).transpose(), run.interval, kSegment);
        if (sum.size() == 0) {
            sum = spectrum.density;
            series.x.assign(spectrum.frequency.begin(), spectrum.frequency.end());
        } else {
            sum += spectrum.density;
        }
    }
    const Eigen::VectorXd root = sum.cwiseSqrt();
    series.y.assign(root.begin(), root.end());
    return series;
}

Plot plotSpectrum(const RunRemainder& run, const WrenchPart& part) {
    Plot plot{std::string("Spectrum of the ") + part.name,
              "frequency [Hz]",
              std::string("density [") + part.density_unit + "]",
              {},
              false,
              true};
    plot.series.push_back(makeSpectrum("demanded", run.demanded, run, part.first, kMeasuredColor));
    plot.series.push_back(makeSpectrum("unexplained", run.unexplained, run, part.first, kAfterColor));
    return plot;
}

Plot plotAutocorrelation(const RunRemainder& run) {
    const Eigen::Index count = run.unexplained.cols();
    const auto overlap = static_cast<Eigen::Index>(std::ceil(run.overlap / run.interval));
    const double shown = std::max(kShownLag, kShownOverlaps * run.overlap) / run.interval;
    const auto lags = static_cast<int>(std::min(shown, static_cast<double>(count / 4)));
    Plot plot{"Autocorrelation of what is left", "lag [ms]", "correlation [-]", {}};
    std::vector<double> at(static_cast<std::size_t>(lags) + 1);
    for (std::size_t k = 0; k < at.size(); ++k) at[k] = 1e3 * static_cast<double>(k) * run.interval;
    double limit = 0;
    for (const WrenchPart& part : kParts)
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::VectorXd r = calcAutocorrelation(run.unexplained.row(part.first + axis).transpose(), lags);
            limit = std::max(limit, calcAutocorrelationLimit(r.head(std::min<Eigen::Index>(overlap, r.size())), count));
            plot.series.push_back({std::string(part.name) + " " + "xyz" [axis], at, { r.begin(), r.end() }});
        }
    for (const double sign : {1.0, -1.0}) {
        std::vector<double> x, y;
        for (const double lag : at) {
            if (lag < 1e3 * run.overlap) continue;
            x.push_back(lag);
            y.push_back(sign * limit);
        }
        plot.series.push_back(
            {sign > 0 ? "95 % of noise, above" : "95 % of noise, below", x, y, false, kMeasuredColor});
    }
    return plot;
}

}  // namespace

void addRemainder(HtmlReport& page, const RunRemainder& run, const std::string& name) {
    page.addHeading("What the equations leave: " + name);
    page.addText(
        "The wrench about the mobile frame's origin that the motion demands of the mount and the fitted laws do not "
        "give, averaged with the test function of the equations. A complete model leaves noise: no trend in time, "
        "nothing that rises where the mount is driven, and beyond " +
        formatNumber(1e3 * run.overlap, 3) +
        " ms, where averages have no samples in common, an autocorrelation within the lines; but the noise of "
        "displacements that were fused with accelerations is itself correlated over some tens of milliseconds.");
    for (const WrenchPart& part : kParts) page.addPlot(plotTime(run, part));
    if (run.unexplained.cols() < kFewest) return;
    page.addPlots({plotSpectrum(run, kParts[0]), plotSpectrum(run, kParts[1]), plotAutocorrelation(run)});
}

}  // namespace wems::identify::commands
