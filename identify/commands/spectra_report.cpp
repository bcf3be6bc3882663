// The page of `identify spectra`.
#include <cmath>
#include <functional>
#include <map>

#include "identify/commands/level_overlay.hpp"
#include "identify/commands/spectra_output.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {
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
