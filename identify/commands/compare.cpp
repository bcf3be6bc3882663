// Errors of a simulated recording, channel by channel, by frequency band and by regime.
#include "identify/commands/compare.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "identify/commands/format.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/commands/run_pictures.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/spectra/welch.hpp"
#include "models/common/format_number.hpp"
#include "models/report/html_report.hpp"

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

namespace {

constexpr double kLeastShareDrawn = 1e-3;  // of a channel in the error

nlohmann::json formatBands(const std::vector<BandError>& bands) {
    auto result = nlohmann::json::array();
    for (const BandError& band : bands)
        result.push_back({{"from", band.from}, {"to", band.to}, {"error", numberOrNull(band.error)}});
    return result;
}

void addRegimes(nlohmann::json& entry, const std::optional<double>& free, const std::optional<double>& contact) {
    if (free) entry["free"] = numberOrNull(*free);
    if (contact) entry["contact"] = numberOrNull(*contact);
}

nlohmann::json formatComparison(const Comparison& comparison) {
    auto channels = nlohmann::json::array();
    for (const ChannelError& channel : comparison.channels) {
        nlohmann::json entry = {{"name", channel.name},
                                {"error", numberOrNull(channel.error)},
                                {"rms", channel.rms},
                                {"share", channel.share},
                                {"bands", formatBands(channel.bands)}};
        addRegimes(entry, channel.free, channel.contact);
        channels.push_back(entry);
    }
    nlohmann::json result = {{"error", numberOrNull(comparison.error)},
                             {"channels", channels},
                             {"bands", formatBands(comparison.bands)},
                             {"time", {comparison.from, comparison.to}},
                             {"units", {{"rms", "m"}, {"bands", "Hz"}, {"time", "s"}}},
                             {"notes", comparison.notes}};
    addRegimes(result, comparison.free, comparison.contact);
    return result;
}

std::string formatHundredths(double fraction) {
    return std::isfinite(fraction) ? formatNumber(100 * fraction, 3) : std::string("-");
}
std::string formatHundredths(const std::optional<double>& fraction) {
    return fraction ? formatHundredths(*fraction) : std::string("-");
}

/// A channel that only trembles needs no digits.
std::string formatShare(double share) {
    return share < 1e-4 ? "< 0.01" : formatHundredths(share);
}

std::string describeError(const Comparison& comparison) {
    std::string text = "error " + formatHundredths(comparison.error) + " % of the measured relative displacement, " +
                       formatNumber(comparison.from, 5) + " to " + formatNumber(comparison.to, 5) + " s";
    if (comparison.free || comparison.contact)
        text += "; free " + formatHundredths(comparison.free) + " %, with a stop touched " +
                formatHundredths(comparison.contact) + " %";
    return text;
}

/// One sentence with engineering units.
std::string makeHeadline(const Comparison& comparison) {
    const ChannelError* worst = nullptr;
    double squares = 0;
    for (const ChannelError& channel : comparison.channels) {
        squares += channel.rms * channel.rms;
        if (worst == nullptr || channel.share > worst->share) worst = &channel;
    }
    const double off = comparison.error * std::sqrt(squares / static_cast<double>(comparison.channels.size()));
    std::string text = "The simulation is off by " + formatNumber(1e3 * off, 3) + " mm RMS, " +
                       formatHundredths(comparison.error) + " % of the measured relative displacement";
    if (worst != nullptr && worst->share > 0)
        text += "; " + formatHundredths(worst->share) + " % of the squared error sits at " + worst->name;
    return text + ".";
}

Table makeTable(const Comparison& comparison) {
    const bool regimes = comparison.free || comparison.contact;
    std::vector<std::string> header{"channel", "RMS [mm]", "error [%]", "share [%]"};
    if (regimes) header.insert(header.end(), {"free [%]", "contact [%]"});
    for (const BandError& band : comparison.bands)
        header.push_back(formatNumber(band.from, 3) + "–" + formatNumber(band.to, 3) + " Hz");
    Table table(header);
    const auto addRow = [&](const ChannelError& channel) {
        std::vector<std::string> row{channel.name, formatNumber(1e3 * channel.rms, 3), formatHundredths(channel.error),
                                     formatShare(channel.share)};
        if (regimes) row.insert(row.end(), {formatHundredths(channel.free), formatHundredths(channel.contact)});
        for (const BandError& band : comparison.bands) {
            std::string cell = "-";
            for (const BandError& own : channel.bands)
                if (own.from == band.from) cell = formatHundredths(own.error);
            row.push_back(cell);
        }
        table.addRow(row);
    };
    for (const ChannelError& channel : comparison.channels) addRow(channel);
    addRow({"all", comparison.error, NAN, 1, comparison.bands, comparison.free, comparison.contact});
    return table;
}

}  // namespace

CompareAnswer runCompare(const CompareRequest& request, Watcher& watcher) {
    CompareAnswer answer;
    answer.record = beginRecord("compare");
    answer.measured = request.measured.file;
    answer.simulated = request.simulated.file;
    const DeviceInputs inputs =
        readInputs(request.model, request.columns, request.geometry,
                   {{"measured", request.measured}, {"simulated", request.simulated}}, answer.record, watcher);
    const std::optional<MountModel>& model = inputs.model;
    // A simulated recording has no columns of the laboratory's sensors.
    const std::optional<ColumnMap> map = readOptionalMap(request.columns);
    const double share_of_reading = model ? 0.5 : 0.9;
    watcher.onStep({"reading " + answer.measured});
    const Recording measured = readSource(request.measured, inputs.findMap());
    watcher.onStep({"reading " + answer.simulated, share_of_reading / 2, 1});
    const Recording simulated = readSource(request.simulated, map ? &*map : nullptr);
    watcher.onStep({"comparing", share_of_reading, 1});
    for (const auto* recording : {&measured, &simulated})
        for (const auto& warning : recording->warnings) answer.warnings.push_back(recording->file + ": " + warning);
    if (model) {
        answer.comparison =
            compare(calcRelativeDisplacement(measured, *model), calcRelativeDisplacement(simulated, *model), &*model);
    } else {
        answer.comparison = compare(calcRelativeDisplacement(measured), calcRelativeDisplacement(simulated), nullptr);
        answer.comparison.notes.emplace_back(
            "without --model the difference of both ends' displacements is compared as it stands; with it, in the axes "
            "of the fixed part as they turn");
    }
    return answer;
}

nlohmann::json toJson(const CompareAnswer& answer) {
    nlohmann::json result = formatComparison(answer.comparison);
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const CompareAnswer& answer, TextStyle style) {
    std::string text = describeError(answer.comparison) + "\n\n" + makeTable(answer.comparison).format(style);
    for (const auto& note : answer.comparison.notes) text += "note: " + note + "\n";
    return text;
}

void writeReport(const CompareAnswer& answer, const std::string& file, OutputFiles& outputs) {
    const Comparison& comparison = answer.comparison;
    HtmlReport page("Comparison of " + answer.simulated + " with " + answer.measured);
    page.addLead(makeHeadline(comparison));
    page.addText(describeError(comparison) + ".");
    const Table table = makeTable(comparison);
    page.addTable(table.header(), table.rows());
    page.addText(
        "RMS: of the measured relative displacement. Error: RMS of simulated minus measured over it, in the whole run "
        "and "
        "in bands of the swept frequency. Share: of the channel in the sum of all squared errors.");
    Plot plot{"Error by band of swept frequency", "swept frequency [Hz]", "error [%]", {}, false};
    const auto addSeries = [&](const std::string& name, const std::vector<BandError>& bands) {
        Series series{name, {}, {}};
        for (const BandError& band : bands) {
            series.x.push_back(std::sqrt(band.from * band.to));
            series.y.push_back(100 * band.error);
        }
        plot.series.push_back(std::move(series));
    };
    addSeries("all", comparison.bands);
    std::string left_out;
    for (const ChannelError& channel : comparison.channels)
        if (channel.share >= kLeastShareDrawn) {
            addSeries(channel.name, channel.bands);
        } else {
            left_out += " " + channel.name;
        }
    page.addPlot(plot);
    if (!left_out.empty())
        page.addText("Not drawn, as they hold less than " + formatHundredths(kLeastShareDrawn) +
                     " % of the error:" + left_out);
    addComparedMotions(page, comparison);
    if (!comparison.notes.empty()) page.addHeading("How the motion was obtained");
    page.addList(comparison.notes);
    page.write(file, outputs);
}

}  // namespace wems::identify::commands
