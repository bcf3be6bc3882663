// The page of `identify spectra`.
#include "identify/commands/spectra_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "identify/commands/spectra.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

namespace {

/// Acceleration of the mobile part with the largest RMS along the drive; without one its displacement.
std::string chooseChannel(const RunSpectra& run) {
    const auto drive = parseChannelName(run.reference);
    std::string best;
    for (const Derivative derivative : {Derivative::acceleration, Derivative::displacement}) {
        double largest = 0;
        for (const ChannelLevel& level : run.channels) {
            const auto name = parseChannelName(level.name);
            if (name->part != Part::mobile || name->derivative != derivative || name->axis != drive->axis) continue;
            if (level.rms > largest) {
                largest = level.rms;
                best = level.name;
            }
        }
        if (!best.empty()) break;
    }
    return best;
}

const OrderTrack* findTrack(const OrderTracking& orders, const std::string& channel) {
    const auto found = std::find_if(orders.tracks.begin(), orders.tracks.end(),
                                    [&](const OrderTrack& track) { return track.channel == channel; });
    return found == orders.tracks.end() ? nullptr : &*found;
}

void addResponse(const RunSpectra& run, const std::string& channel, LevelCurve& curve) {
    const OrderTrack *output = findTrack(run.orders, channel), *input = findTrack(run.orders, run.reference);
    const auto add = [&](double hertz, double response) {
        if (!(std::isfinite(response) && hertz >= run.lowest && hertz <= run.highest)) return;
        curve.hertz.push_back(hertz);
        curve.response.push_back(response);
    };
    if (output != nullptr && input != nullptr && run.highest > 1.05 * run.lowest) {
        for (Eigen::Index p = 0; p < output->amplitude.cols(); ++p)
            add(run.orders.hertz[p], output->amplitude(0, p) / input->amplitude(0, p));
        return;
    }
    for (const ChannelTransfer& transfer : run.transfers)
        if (transfer.output == channel)
            for (Eigen::Index k = 0; k < run.spectra.frequency.size(); ++k)
                add(run.spectra.frequency[k], std::abs(transfer.estimate.h1[k]));
}

void addMargins(const Margins& margins, LevelCurve& curve) {
    for (const ConnectionMargin& margin : margins.connections) {
        curve.stroke = std::max({curve.stroke, margin.highest, -margin.lowest});
        for (const auto& left : {margin.left_negative, margin.left_positive})
            if (left) curve.left = curve.left ? std::min(*curve.left, *left) : *left;
    }
}

std::string formatDrive(const LevelOverlay& overlay, const LevelCurve& curve) {
    const SpectrumUnit unit = findSpectrumUnit(overlay.drive);
    return formatNumber(unit.factor * curve.drive, 3) + " " + unit.name + " RMS";
}

}  // namespace

std::optional<LevelOverlay> makeLevelOverlay(const std::vector<RunSpectra>& runs) {
    if (runs.size() < 2 || runs.front().reference.empty()) return std::nullopt;
    LevelOverlay overlay;
    overlay.reference = runs.front().reference;
    overlay.channel = chooseChannel(runs.front());
    if (overlay.channel.empty()) return std::nullopt;
    for (const RunSpectra& run : runs) {
        LevelCurve curve;
        curve.file = run.file;
        if (run.reference != overlay.reference) return std::nullopt;
        for (const ChannelLevel& level : run.channels)
            if (level.name == run.reference) {
                curve.drive = level.rms;
                overlay.drive = level.quantity;
            }
        for (const ChannelTransfer& transfer : run.transfers)
            if (transfer.output == overlay.channel) overlay.unit = transfer.unit;
        addResponse(run, overlay.channel, curve);
        if (curve.response.empty()) return std::nullopt;
        const auto peak = std::max_element(curve.response.begin(), curve.response.end());
        curve.peak = *peak;
        curve.peak_hertz = curve.hertz[peak - curve.response.begin()];
        addMargins(run.margins, curve);
        overlay.curves.push_back(std::move(curve));
    }
    std::stable_sort(overlay.curves.begin(), overlay.curves.end(),
                     [](const LevelCurve& a, const LevelCurve& b) { return a.drive < b.drive; });
    return overlay;
}

Table tabulateLevels(const LevelOverlay& overlay) {
    const bool margins = std::any_of(overlay.curves.begin(), overlay.curves.end(),
                                     [](const LevelCurve& curve) { return curve.left.has_value(); });
    std::vector<std::string> header{"run", "drive", "largest at [Hz]", "largest [" + overlay.unit + "]", "stroke [mm]"};
    if (margins) header.emplace_back("least left [mm]");
    Table table(header);
    for (const LevelCurve& curve : overlay.curves) {
        std::vector<std::string> row{curve.file, formatDrive(overlay, curve), formatNumber(curve.peak_hertz, 4),
                                     formatNumber(curve.peak, 4), formatNumber(1e3 * curve.stroke, 4)};
        if (margins) row.push_back(curve.left ? formatNumber(1e3 * *curve.left, 4) : "-");
        table.addRow(row);
    }
    return table;
}

Plot plotLevels(const LevelOverlay& overlay) {
    Plot plot{"Levels overlaid: " + overlay.channel + " over " + overlay.reference,
              "frequency [Hz]",
              "[" + overlay.unit + "]",
              {},
              false,
              true};
    for (const LevelCurve& curve : overlay.curves)
        plot.series.push_back({curve.file + ", " + formatDrive(overlay, curve), curve.hertz, curve.response});
    return plot;
}

std::string describeLevels(const LevelOverlay& overlay) {
    const LevelCurve &low = overlay.curves.front(), &high = overlay.curves.back();
    return "From " + formatDrive(overlay, low) + " to " + formatDrive(overlay, high) + " the largest response of " +
           overlay.channel + " over " + overlay.reference + " goes from " + formatNumber(low.peak, 3) + " at " +
           formatNumber(low.peak_hertz, 4) + " Hz to " + formatNumber(high.peak, 3) + " at " +
           formatNumber(high.peak_hertz, 4) + " Hz; a linear device would not change.";
}

namespace {

std::vector<double> listCurves(const Eigen::VectorXd& values, double factor = 1) {
    const Eigen::VectorXd scaled = factor * values;
    return {scaled.begin(), scaled.end()};
}

std::string nameSeries(const std::vector<RunSpectra>& runs, const RunSpectra& run, const std::string& channel) {
    return runs.size() > 1 ? run.file + ": " + channel : channel;
}

/// `mobile part, acceleration z`: channels of one kind and axis share a picture.
std::string nameGroup(const std::string& channel) {
    const auto name = parseChannelName(channel);
    static const std::map<Part, std::string> parts{{Part::mobile, "mobile part"}, {Part::fixed, "fixed part"},
                                                   {Part::load, "load"},          {Part::base, "base"},
                                                   {Part::relative, "relative"},  {Part::force, "force"}};
    const char* what = name->derivative == Derivative::displacement   ? "displacement"
                       : name->derivative == Derivative::velocity     ? "velocity"
                       : name->derivative == Derivative::acceleration ? "acceleration"
                                                                      : "force";
    return parts.at(name->part) + ", " + what + " " + "xyz"[name->axis];
}

/// Pictures in order of first appearance; those in which nothing is drawn are left out.
class Pictures {
public:
    Plot& find(const std::string& title, const std::string& x_label, const std::string& y_label, bool log_y) {
        for (Plot& plot : plots_)
            if (plot.title == title && plot.y_label == y_label) return plot;
        Plot plot;
        plot.title = title;
        plot.x_label = x_label;
        plot.y_label = y_label;
        plot.log_y = log_y;
        plots_.push_back(plot);
        return plots_.back();
    }
    void addTo(HtmlReport& page, const std::string& heading) const {
        if (plots_.empty()) return;
        page.addHeading(heading);
        for (const Plot& plot : plots_) page.addPlot(plot);
    }

private:
    std::vector<Plot> plots_;
};

/// Bins within the band, widened by a third of an octave.
Eigen::Index firstBin(const RunSpectra& run) {
    Eigen::Index k = 1;
    while (k + 1 < run.spectra.frequency.size() && run.spectra.frequency[k] < run.lowest / 1.26) ++k;
    return k;
}
Eigen::Index lastBin(const RunSpectra& run) {
    Eigen::Index k = run.spectra.frequency.size() - 1;
    while (k > 1 && run.spectra.frequency[k] > run.highest * 1.26) --k;
    return k;
}

void addTransfers(const std::vector<RunSpectra>& runs, bool transmissibility, HtmlReport& page) {
    Pictures sizes, coherences;
    for (const RunSpectra& run : runs) {
        const Eigen::Index from = firstBin(run), count = std::max<Eigen::Index>(1, lastBin(run) - from + 1);
        const std::vector<double> f = listCurves(run.spectra.frequency.segment(from, count));
        for (const ChannelTransfer& transfer : transmissibility ? run.transmissibilities : run.transfers) {
            // What does not answer the drive anywhere is not drawn.
            const Eigen::VectorXd coherence = transfer.estimate.coherence.segment(from, count);
            if (!((coherence.array() > coherenceThreshold95(run.spectra.degrees_of_freedom)).any())) continue;
            const std::string group = nameGroup(transfer.output);
            const std::string over = transmissibility ? "over the fixed part" : "over " + transfer.input;
            const std::string name = nameSeries(runs, run, transfer.output);
            sizes.find("H1 of " + group + " " + over, "frequency [Hz]", "[" + transfer.unit + "]", true)
                .series.push_back({name, f, listCurves(transfer.estimate.h1.segment(from, count).cwiseAbs())});
            coherences.find("Coherence of " + group + " " + over, "frequency [Hz]", "coherence [-]", false)
                .series.push_back({name, f, listCurves(coherence)});
        }
    }
    sizes.addTo(page, transmissibility ? "Transmissibility" : "Frequency response");
    if (!transmissibility) coherences.addTo(page, "Coherence");
}

void addDensities(const std::vector<RunSpectra>& runs, HtmlReport& page) {
    Pictures pictures;
    for (const RunSpectra& run : runs)
        for (std::size_t c = 0; c < run.channels.size(); ++c) {
            const ChannelLevel& level = run.channels[c];
            if (!(level.rms > 0)) continue;
            const SpectrumUnit unit = findSpectrumUnit(level.quantity);
            const Eigen::Index count = run.spectra.frequency.size() - 1;
            pictures
                .find("Density of " + nameGroup(level.name), "frequency [Hz]",
                      std::string("density [") +
                          (std::string(unit.name).size() > 2 ? "(" + std::string(unit.name) + ")" : unit.name) +
                          "^2/Hz]",
                      true)
                .series.push_back({nameSeries(runs, run, level.name), listCurves(run.spectra.frequency.tail(count)),
                                   listCurves(run.spectra.density.col(c).tail(count), unit.factor * unit.factor)});
        }
    pictures.addTo(page, "Power spectral density");
}

void addOrders(const std::vector<RunSpectra>& runs, HtmlReport& page) {
    Pictures pictures;
    for (const RunSpectra& run : runs)
        for (const OrderTrack& track : run.orders.tracks) {
            const auto name = parseChannelName(track.channel);
            if (!name) continue;
            const SpectrumUnit unit = findSpectrumUnit(findQuantity(*name));
            const Eigen::VectorXd first = track.amplitude.row(0).transpose();
            if (!(first.array() > 0).any()) continue;
            pictures
                .find("First order of " + nameGroup(track.channel), "swept frequency [Hz]",
                      std::string("amplitude [") + unit.name + "]", false)
                .series.push_back(
                    {nameSeries(runs, run, track.channel), run.orders.hertz, listCurves(first, unit.factor)});
        }
    pictures.addTo(page, "Orders along the sweep");
}

void addShockResponses(const std::vector<RunSpectra>& runs, HtmlReport& page) {
    Pictures pictures;
    for (const RunSpectra& run : runs)
        for (std::size_t i = 0; i < run.shocks.size(); ++i) {
            const ShockResponse& shock = run.shocks[i];
            if (shock.frequency.empty() || !(shock.maximax.array() > 0).any()) continue;
            pictures
                .find("Shock response of " + nameGroup(run.shock_channels[i]), "natural frequency [Hz]",
                      "largest acceleration [g]", true)
                .series.push_back({nameSeries(runs, run, run.shock_channels[i]), shock.frequency,
                                   listCurves(shock.maximax, findSpectrumUnit(Quantity::acceleration).factor)});
        }
    pictures.addTo(page, "Shock response spectrum");
}

/// The largest amplification along the direction of the drive, where both ends of the connection tell the same.
std::string describeLargestPeak(const std::vector<RunSpectra>& runs) {
    constexpr double least_coherence = 0.8;
    const ChannelTransfer* best = nullptr;
    const ResponsePeak* largest = nullptr;
    for (const RunSpectra& run : runs) {
        const auto drive = parseChannelName(run.reference);
        for (const ChannelTransfer& transfer : run.transmissibilities) {
            if (!drive || parseChannelName(transfer.output)->axis != drive->axis) continue;
            for (const ResponsePeak& peak : transfer.peaks)
                if (transfer.estimate.coherence[peak.bin] > least_coherence &&
                    (largest == nullptr || peak.amplitude > largest->amplitude)) {
                    best = &transfer;
                    largest = &peak;
                }
        }
    }
    if (best == nullptr) return "No resonance stands out of the transmissibilities along the drive.";
    return "The largest transmissibility along the drive is " + formatNumber(largest->amplitude, 3) + " at " +
           formatNumber(largest->frequency, 4) + " Hz (" + best->output + " over " + best->input + ").";
}

}  // namespace

void writeSpectraReport(const std::vector<RunSpectra>& runs, const std::string& file, OutputFiles& outputs) {
    HtmlReport page(runs.size() > 1 ? "Spectra of " + std::to_string(runs.size()) + " runs"
                                    : "Spectra of " + runs[0].file);
    page.addLead(describeLargestPeak(runs));
    if (const auto overlay = makeLevelOverlay(runs)) {
        page.addLead(describeLevels(*overlay));
        page.addPlot(plotLevels(*overlay));
        const Table table = tabulateLevels(*overlay);
        page.addTable(table.header(), table.rows());
    }
    for (const RunSpectra& run : runs) {
        page.addHeading(run.file);
        page.addText(formatNumber(run.spectra.resolution, 4) + " Hz resolution, " +
                     std::to_string(run.spectra.segments) + " segments, " +
                     formatNumber(run.spectra.degrees_of_freedom, 3) + " degrees of freedom" +
                     (run.reference.empty() ? "" : "; driven by " + run.reference) + ".");
        const auto addTable = [&](const Table& table) {
            if (!table.empty()) page.addTable(table.header(), table.rows());
        };
        addTable(tabulateMargins(run.margins));
        addTable(tabulatePeaks(run.transmissibilities));
        addTable(tabulateLevels(run));
        page.addList(run.margins.notes);
    }
    addTransfers(runs, true, page);
    addTransfers(runs, false, page);
    addOrders(runs, page);
    addDensities(runs, page);
    addShockResponses(runs, page);
    page.write(file, outputs);
}

}  // namespace wems::identify::commands
