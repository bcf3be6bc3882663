#include "identify/commands/compare_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/commands/judged_runs.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/spectra/welch.hpp"
#include "models/format_number.hpp"

namespace wems::identify::commands {
namespace {

constexpr std::size_t kMostMoving = 3, kMostErring = 2;  // channels
constexpr Eigen::Index kEnvelopeStretches = 400;         // of an envelope
constexpr double kPeriodsOfMoment = 8;                   // around a moment
constexpr double kMomentWithoutSine = 0.3;               // s
constexpr double kMillimetres = 1e3;

/// Rows to draw, in the order of the channels.
std::vector<Eigen::Index> chooseRows(const Comparison& comparison) {
    std::vector<Eigen::Index> all(comparison.channels.size()), chosen;
    std::iota(all.begin(), all.end(), Eigen::Index{0});
    const auto take = [&](std::size_t most, const auto& size) {
        std::stable_sort(all.begin(), all.end(), [&](Eigen::Index a, Eigen::Index b) { return size(a) > size(b); });
        for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
            if (size(all[i]) > 0 && std::find(chosen.begin(), chosen.end(), all[i]) == chosen.end())
                chosen.push_back(all[i]);
    };
    const auto channel = [&](Eigen::Index row) { return comparison.channels[row]; };
    take(kMostMoving, [&](Eigen::Index row) { return channel(row).rms; });
    take(kMostErring, [&](Eigen::Index row) { return channel(row).share; });
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

class Overlay {
public:
    explicit Overlay(const Comparison& comparison) : c_(comparison) {
        swept_.hertz = c_.swept_frequency;
        for (const double hertz : swept_.hertz) {
            if (!std::isfinite(hertz)) continue;
            swept_.lowest = swept_.is_sine ? std::min(swept_.lowest, hertz) : hertz;
            swept_.highest = std::max(swept_.highest, hertz);
            swept_.is_sine = true;
        }
    }

    void addTo(HtmlReport& page, Eigen::Index row) const {
        const std::string& name = c_.channels[row].name;
        page.addHeading("Measured and simulated at " + name);
        page.addPlot(sweeps() ? plotEnvelope(row, name)
                              : plotTime("Relative displacement " + name, row, 0, c_.measured.cols()));
        Eigen::Index largest = 0, worst = 0;
        c_.measured.row(row).cwiseAbs().maxCoeff(&largest);
        (c_.simulated.row(row) - c_.measured.row(row)).cwiseAbs().maxCoeff(&worst);
        page.addPlots({plotMoment("Around the largest motion, " + name, row, largest),
                       plotMoment("Around the largest error, " + name, row, worst)});
        if (sweeps()) page.addPlots(plotOrders(row, name));
        if (const Plot spectrum = plotSpectrum(row, name); !spectrum.series.empty()) page.addPlot(spectrum);
    }

private:
    bool sweeps() const { return swept_.is_sine && swept_.highest > 1.05 * swept_.lowest; }

    void addBoth(Plot& plot, std::vector<double> x, std::vector<double> measured, std::vector<double> simulated) const {
        plot.series.push_back({"measured", x, std::move(measured), std::nullopt, kMeasuredColor});
        plot.series.push_back({"simulated", std::move(x), std::move(simulated), std::nullopt, kBeforeColor});
    }

    Plot plotTime(const std::string& title, Eigen::Index row, Eigen::Index first, Eigen::Index count) const {
        Plot plot{title, "time [s]", "relative displacement [mm]", {}, false};
        const Eigen::RowVectorXd measured = kMillimetres * c_.measured.row(row).segment(first, count),
                                 simulated = kMillimetres * c_.simulated.row(row).segment(first, count);
        addBoth(plot, {c_.time.begin() + first, c_.time.begin() + first + count}, {measured.begin(), measured.end()},
                {simulated.begin(), simulated.end()});
        return plot;
    }

    Plot plotMoment(const std::string& title, Eigen::Index row, Eigen::Index middle) const {
        const double hertz = c_.swept_frequency[middle];
        const double length = hertz > 0 ? kPeriodsOfMoment / hertz : kMomentWithoutSine;
        const Eigen::Index count = std::clamp<Eigen::Index>(std::lround(length / interval()), 2, c_.measured.cols());
        const Eigen::Index first = std::clamp<Eigen::Index>(middle - count / 2, 0, c_.measured.cols() - count);
        return plotTime(title + (hertz > 0 ? ", " + formatNumber(hertz, 4) + " Hz" : ""), row, first, count);
    }

    /// Largest magnitude of stretches of a period or longer.
    Plot plotEnvelope(Eigen::Index row, const std::string& name) const {
        Plot plot{"Envelope of the relative displacement " + name, "swept frequency [Hz]", "largest [mm]", {}, false};
        std::vector<double> x, measured, simulated;
        const Eigen::Index columns = c_.measured.cols(),
                           shortest = std::max<Eigen::Index>(1, columns / kEnvelopeStretches);
        for (Eigen::Index first = 0; first < columns;) {
            const double hertz = swept_.hertz[first];
            Eigen::Index count = shortest;
            if (hertz > 0) count = std::max<Eigen::Index>(count, std::lround(1 / (hertz * interval())));
            count = std::min(count, columns - first);
            if (std::isfinite(hertz)) {
                x.push_back(swept_.hertz[first + count / 2]);
                measured.push_back(kMillimetres * c_.measured.row(row).segment(first, count).cwiseAbs().maxCoeff());
                simulated.push_back(kMillimetres * c_.simulated.row(row).segment(first, count).cwiseAbs().maxCoeff());
            }
            first += count;
        }
        addBoth(plot, std::move(x), std::move(measured), std::move(simulated));
        return plot;
    }

    std::vector<Plot> plotOrders(Eigen::Index row, const std::string& name) const {
        Recording both;
        both.time = c_.time;
        for (const auto* motion : {&c_.measured, &c_.simulated}) {
            const Eigen::RowVectorXd q = motion->row(row);
            both.channels.push_back({motion == &c_.measured ? "measured" : "simulated", "m", {q.begin(), q.end()}, 0});
        }
        const OrderTracking orders = trackOrders(both, swept_);
        std::vector<Plot> plots;
        for (int order = 0; order < tracked_orders; ++order) {
            Plot plot{"Order " + std::to_string(order + 1) + " at " + name,
                      "swept frequency [Hz]",
                      "amplitude [mm]",
                      {},
                      false,
                      true};
            const auto values = [&](std::size_t track) {
                const Eigen::RowVectorXd amplitude = kMillimetres * orders.tracks[track].amplitude.row(order);
                return std::vector<double>(amplitude.begin(), amplitude.end());
            };
            addBoth(plot, orders.hertz, values(0), values(1));
            plots.push_back(std::move(plot));
        }
        return plots;
    }

    Plot plotSpectrum(Eigen::Index row, const std::string& name) const {
        Plot plot{
            "Spectrum of the relative displacement " + name, "frequency [Hz]", "density [(mm)^2/Hz]", {}, false, true};
        constexpr int averages = 20;
        constexpr Eigen::Index fewest = 64;  // samples that make a spectrum
        if (c_.measured.cols() < fewest) return plot;
        Eigen::MatrixXd signals(c_.measured.cols(), 2);
        signals << c_.measured.row(row).transpose(), c_.simulated.row(row).transpose();
        WelchSettings welch;
        welch.segment = chooseSegment(signals.rows(), averages);
        const CrossSpectra spectra = estimateSpectra(kMillimetres * signals, 0, interval(), welch);
        // As far as there is more than the sensors' noise in either.
        constexpr double least = 1e-7;  // of the largest density
        const double threshold = least * spectra.density.maxCoeff();
        Eigen::Index last = spectra.density.rows() - 1;
        while (last > 1 && spectra.density.row(last).maxCoeff() < threshold) --last;
        const auto take = [&](const auto& column) {
            const Eigen::VectorXd part = column.segment(1, last);
            return std::vector<double>(part.begin(), part.end());
        };
        addBoth(plot, take(spectra.frequency), take(spectra.density.col(0)), take(spectra.density.col(1)));
        return plot;
    }

    double interval() const { return (c_.time.back() - c_.time.front()) / static_cast<double>(c_.time.size() - 1); }

    const Comparison& c_;
    SweptFrequency swept_;
};

}  // namespace

void addComparedMotions(HtmlReport& page, const Comparison& comparison) {
    const Overlay overlay(comparison);
    for (const Eigen::Index row : chooseRows(comparison)) overlay.addTo(page, row);
}

}  // namespace wems::identify::commands
