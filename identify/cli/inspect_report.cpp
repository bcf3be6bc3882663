#include "identify/cli/inspect_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "identify/cli/command.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

constexpr Eigen::Index report_lines = 512;  // of a picture, not of an analysis
constexpr double degrees = 180 / 3.14159265358979323846;

std::string describeDrive(const SweptFrequency& swept) {
    if (swept.source.empty()) return "no drive is visible";
    const std::string band = formatNumber(swept.lowest, 4) + " to " + formatNumber(swept.highest, 4) + " Hz";
    if (!swept.is_sine) return "broadband, " + band + " (seen in: " + swept.source + ")";
    const bool sweeps = swept.highest > 1.05 * swept.lowest;
    return (sweeps ? "sine sweep, " : "sine, ") + band + " (seen in: " + swept.source + ")";
}

std::string describeRecording(const Inspection& inspection, const Recording& recording) {
    return recording.file + ": " + recording.format + ", " + std::to_string(inspection.samples) + " samples, " +
           formatNumber(inspection.rate, 6) + " Hz, " + formatNumber(inspection.duration, 6) + " s; " +
           describeDrive(inspection.swept);
}

/// Largest amplitude of an order along the sweep and where.
std::string formatPeak(const OrderTrack& track, const OrderTracking& orders, int order) {
    double largest = 0, at = 0;
    for (Eigen::Index p = 0; p < track.amplitude.cols(); ++p) {
        if (!(track.amplitude(order, p) > largest)) continue;
        largest = track.amplitude(order, p);
        at = orders.hertz[static_cast<std::size_t>(p)];
    }
    return largest > 0 ? formatNumber(largest, 3) + " @ " + formatNumber(at, 3) : "-";
}

Table makeTable(const Inspection& inspection) {
    std::vector<std::string> header{"channel", "unit",  "RMS",    "mean",        "lowest",
                                    "highest", "noise", "S/N dB", "99 % band Hz"};
    const bool tracked = !inspection.orders.tracks.empty();
    if (tracked) header.insert(header.end(), {"order 1 @ Hz", "order 2 @ Hz", "order 3 @ Hz"});
    Table table(header);
    for (std::size_t i = 0; i < inspection.channels.size(); ++i) {
        const ChannelStatistics& channel = inspection.channels[i];
        std::vector<std::string> row{channel.name,
                                     channel.unit,
                                     formatNumber(channel.rms, 3),
                                     formatNumber(channel.mean, 2),
                                     formatNumber(channel.lowest, 3),
                                     formatNumber(channel.highest, 3),
                                     formatNumber(channel.noise, 2),
                                     formatNumber(channel.signal_to_noise, 3),
                                     formatNumber(channel.band_from, 3) + "-" + formatNumber(channel.band_to, 3)};
        for (int order = 0; tracked && order < tracked_orders; ++order)
            row.push_back(formatPeak(inspection.orders.tracks[i], inspection.orders, order));
        table.addRow(row);
    }
    return table;
}

std::vector<std::string> makeSentences(const Inspection& inspection, const Recording& recording) {
    std::vector<std::string> lines;
    if (!recording.unused_columns.empty()) {
        std::string line = "Not a channel: ";
        for (std::size_t i = 0; i < recording.unused_columns.size() && i < 12; ++i)
            line += (i > 0 ? ", " : "") + recording.unused_columns[i];
        if (recording.unused_columns.size() > 12)
            line += " and " + std::to_string(recording.unused_columns.size() - 12) + " more";
        lines.push_back(line);
    }
    for (const auto& warning : recording.warnings) {
        bool found = false;
        for (const Finding& finding : inspection.findings) found = found || finding.message == warning;
        if (!found) lines.push_back("Note: " + warning);
    }
    for (const auto& note : inspection.notes) lines.push_back("Note: " + note);
    if (inspection.findings.empty()) lines.emplace_back("Nothing suspicious.");
    for (const Finding& finding : inspection.findings) lines.push_back("Suspicious: " + finding.message);
    for (const auto& ability : inspection.abilities) lines.push_back("Identification: " + ability);
    return lines;
}

/// A picture for each kind of quantity: channels of one unit share an axis.
std::map<std::string, std::vector<std::size_t>> groupByUnit(const Inspection& inspection) {
    std::map<std::string, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < inspection.channels.size(); ++i) groups[inspection.channels[i].unit].push_back(i);
    return groups;
}

void addOrderPlots(const Inspection& inspection, HtmlReport& page) {
    for (const auto& [unit, members] : groupByUnit(inspection)) {
        Plot levels{"Orders 1 to 3 along the sweep", "swept frequency [Hz]", "amplitude [" + unit + "]", {}, false};
        Plot phases{"Phase of order 1 against " + inspection.orders.reference,
                    "swept frequency [Hz]",
                    "phase [deg]",
                    {},
                    false};
        for (const std::size_t i : members) {
            const OrderTrack& track = inspection.orders.tracks[i];
            for (int order = 0; order < tracked_orders; ++order) {
                Series series{track.channel + (order > 0 ? " order " + std::to_string(order + 1) : ""),
                              inspection.orders.hertz,
                              {}};
                for (Eigen::Index p = 0; p < track.amplitude.cols(); ++p) series.y.push_back(track.amplitude(order, p));
                levels.series.push_back(std::move(series));
            }
            Series phase{track.channel, inspection.orders.hertz, {}};
            for (Eigen::Index p = 0; p < track.phase.cols(); ++p) phase.y.push_back(degrees * track.phase(0, p));
            phases.series.push_back(std::move(phase));
        }
        page.addPlot(levels);
        page.addPlot(phases);
    }
}

/// Means over neighbouring frequencies.
Spectrum thinOut(const Spectrum& spectrum) {
    const Eigen::Index group = std::max<Eigen::Index>(1, spectrum.density.size() / report_lines),
                       lines = spectrum.density.size() / group;
    Spectrum thin{Eigen::VectorXd(lines), Eigen::VectorXd(lines)};
    for (Eigen::Index i = 0; i < lines; ++i) {
        thin.frequency[i] = spectrum.frequency.segment(i * group, group).mean();
        thin.density[i] = spectrum.density.segment(i * group, group).mean();
    }
    return thin;
}

void addSpectra(const Inspection& inspection, HtmlReport& page) {
    for (const auto& [unit, members] : groupByUnit(inspection)) {
        Plot plot{"Spectral density", "frequency [Hz]", "log10 of density [" + unit + "²/Hz]", {}, false};
        for (const std::size_t i : members) {
            const Spectrum spectrum = thinOut(inspection.channels[i].spectrum);
            Series series{inspection.channels[i].name, {}, {}};
            for (Eigen::Index k = 1; k < spectrum.frequency.size(); ++k) {
                series.x.push_back(spectrum.frequency[k]);
                series.y.push_back(std::log10(spectrum.density[k]));
            }
            plot.series.push_back(std::move(series));
        }
        page.addPlot(plot);
    }
}

}  // namespace

std::string formatInspection(const Inspection& inspection, const Recording& recording, TextStyle style) {
    std::ostringstream text;
    text << describeRecording(inspection, recording) << "\n\n" << makeTable(inspection).format(style) << "\n";
    for (const auto& line : makeSentences(inspection, recording))
        text << (line.rfind("Suspicious", 0) == 0 ? paint(line, Colour::yellow, style) : line) << "\n";
    text << "\n";
    return text.str();
}

InspectReport::InspectReport() : page_(std::make_unique<HtmlReport>("Recordings")) {}
InspectReport::~InspectReport() = default;

void InspectReport::add(const Inspection& inspection, const Recording& recording) {
    page_->addHeading(recording.file);
    page_->addText(describeRecording(inspection, recording));
    const Table table = makeTable(inspection);
    page_->addTable(table.header(), table.rows());
    for (const auto& line : makeSentences(inspection, recording)) page_->addText(line);
    if (!inspection.orders.tracks.empty()) addOrderPlots(inspection, *page_);
    addSpectra(inspection, *page_);
}

void InspectReport::write(const std::string& file) const {
    page_->write(file);
}

}  // namespace wems::identify::cli
