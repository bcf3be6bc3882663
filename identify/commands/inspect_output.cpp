#include "identify/commands/inspect_output.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "identify/commands/format.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

namespace {

std::string nameQuantity(const std::string& unit) {
    if (unit == "m") return "displacement";
    if (unit == "m/s") return "velocity";
    return unit == "m/s^2" ? "acceleration" : unit == "N" ? "force" : unit;
}

}  // namespace

ShownUnit showUnit(const std::string& unit) {
    return unit == "m" ? ShownUnit{"mm", 1e3} : ShownUnit{unit, 1};
}

std::vector<ChannelGroup> groupChannels(const std::vector<std::pair<std::string, std::string>>& channels) {
    std::vector<ChannelGroup> groups;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const auto& [name, unit] = channels[i];
        const std::string title = name.substr(0, name.find('.')) + ", " + nameQuantity(unit);
        auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.title == title; });
        if (group == groups.end()) group = groups.insert(group, {title, showUnit(unit), {}});
        group->members.push_back(i);
    }
    return groups;
}

nlohmann::json makeQualityJson(const QualityVerdict& verdict) {
    using Kind = MeasurementFault::Kind;
    auto faults = nlohmann::json::array();
    for (const MeasurementFault& fault : verdict.faults) {
        nlohmann::json entry{
            {"kind", kindName(fault.kind)}, {"channel", fault.channel}, {"alternatives", fault.alternatives}};
        switch (fault.kind) {
            case Kind::unit:
            case Kind::gain:
            case Kind::sign:
                entry["factor"] = fault.factor;
                break;
            case Kind::exchanged:
                entry["exchanged_with"] = fault.exchanged_with;
                break;
            case Kind::clock_drift:
                entry["drift"] = fault.drift;
                [[fallthrough]];
            case Kind::delay:
                entry["delay"] = fault.delay;
        }
        faults.push_back(entry);
    }
    return {{"verdict", qualityName(verdict.quality)},
            {"reasons", verdict.reasons},
            {"faults", faults},
            {"checked", verdict.checked},
            {"contradiction", verdict.contradiction}};
}

namespace {

constexpr Eigen::Index report_lines = 512;  // of a picture, not of an analysis
constexpr double degrees = 180 / 3.14159265358979323846;

constexpr double least_share = 0.01;  // of an amplitude in the largest of its picture, for its phase to mean something

std::string describeDrive(const SweptFrequency& swept) {
    if (swept.source.empty()) return "no drive is visible";
    const std::string band = formatNumber(swept.lowest, 4) + " to " + formatNumber(swept.highest, 4) + " Hz";
    if (!swept.tones.empty()) {
        std::string tones;
        for (const double tone : swept.tones) tones += (tones.empty() ? "" : ", ") + formatNumber(tone, 4);
        return std::to_string(swept.tones.size()) + " tones at once, " + tones + " Hz (seen in: " + swept.source + ")";
    }
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
std::string formatPeak(const OrderTrack& track, const OrderTracking& orders, int order, double factor) {
    double largest = 0, at = 0;
    for (Eigen::Index p = 0; p < track.amplitude.cols(); ++p) {
        if (!(track.amplitude(order, p) > largest)) continue;
        largest = track.amplitude(order, p);
        at = orders.hertz[p];
    }
    return largest > 0 ? formatNumber(factor * largest, 3) + " @ " + formatNumber(at, 3) : "-";
}

Table makeTable(const Inspection& inspection) {
    std::vector<std::string> header{"channel", "unit",  "RMS",      "mean",          "lowest",
                                    "highest", "noise", "S/N [dB]", "99 % band [Hz]"};
    const bool tracked = !inspection.orders.tracks.empty();
    if (tracked) header.insert(header.end(), {"order 1 @ Hz", "order 2 @ Hz", "order 3 @ Hz"});
    Table table(header);
    for (std::size_t i = 0; i < inspection.channels.size(); ++i) {
        const ChannelStatistics& channel = inspection.channels[i];
        const auto [unit, factor] = showUnit(channel.unit);
        std::vector<std::string> row{channel.name,
                                     unit,
                                     formatNumber(factor * channel.rms, 3),
                                     formatNumber(factor * channel.mean, 2),
                                     formatNumber(factor * channel.lowest, 3),
                                     formatNumber(factor * channel.highest, 3),
                                     formatNumber(factor * channel.noise, 2),
                                     formatNumber(channel.signal_to_noise, 3),
                                     formatNumber(channel.band_from, 3) + "-" + formatNumber(channel.band_to, 3)};
        for (int order = 0; tracked && order < tracked_orders; ++order)
            row.push_back(formatPeak(inspection.orders.tracks[i], inspection.orders, order, factor));
        table.addRow(row);
    }
    return table;
}

std::vector<std::string> makeSentences(const Inspection& inspection, const Recording& recording) {
    std::vector<std::string> lines{formatVerdict(inspection.quality)};
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
    if (inspection.findings.empty() && inspection.quality.quality == Quality::good)
        lines.emplace_back("Nothing suspicious.");
    for (const Finding& finding : inspection.findings) lines.push_back("Suspicious: " + finding.message);
    for (const auto& ability : inspection.abilities) lines.push_back("Identification: " + ability);
    return lines;
}

bool isWarning(const std::string& line) {
    return line.rfind("Suspicious", 0) == 0 || (line.rfind("Quality", 0) == 0 && line != "Quality: good.");
}

/// Amplitudes of one order over the swept frequency.
Plot plotOrder(const Inspection& inspection, const ChannelGroup& group, int order) {
    Plot plot{"Order " + std::to_string(order + 1) + " along the sweep: " + group.title,
              "swept frequency [Hz]",
              "amplitude [" + group.unit.name + "]",
              {}};
    for (const std::size_t i : group.members) {
        const OrderTrack& track = inspection.orders.tracks[i];
        const Eigen::RowVectorXd values = group.unit.factor * track.amplitude.row(order);
        plot.series.push_back({track.channel, inspection.orders.hertz, {values.begin(), values.end()}});
    }
    return plot;
}

/// A gap where a channel hardly moves at the order: its phase is that of the noise.
Plot plotPhase(const Inspection& inspection, const ChannelGroup& group) {
    Plot plot{"Phase of order 1 against " + inspection.orders.reference + ": " + group.title,
              "swept frequency [Hz]",
              "phase [deg]",
              {}};
    double largest = 0;
    for (const std::size_t i : group.members)
        for (const double amplitude : inspection.orders.tracks[i].amplitude.row(0))
            largest = std::fmax(largest, amplitude);
    for (const std::size_t i : group.members) {
        const OrderTrack& track = inspection.orders.tracks[i];
        Series phase{track.channel, {}, {}};
        for (Eigen::Index p = 0; p < track.phase.cols(); ++p) {
            const double hertz = inspection.orders.hertz[p];
            const double now = track.amplitude(0, p) >= least_share * largest ? degrees * track.phase(0, p) : NAN;
            if (!phase.y.empty() && std::abs(now - phase.y.back()) > 180) {  // out at one end, in at the other
                phase.x.push_back(0.5 * (hertz + phase.x.back()));
                phase.y.push_back(NAN);
            }
            phase.x.push_back(hertz);
            phase.y.push_back(now);
        }
        plot.series.push_back(std::move(phase));
    }
    return plot;
}

void addOrderPlots(const Inspection& inspection, const ChannelGroup& group, HtmlReport& page) {
    page.addPlot(plotOrder(inspection, group, 0));
    std::vector<Plot> small{plotPhase(inspection, group)};
    for (int order = 1; order < tracked_orders; ++order) small.push_back(plotOrder(inspection, group, order));
    page.addPlots(small);
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

void addSpectra(const Inspection& inspection, const ChannelGroup& group, HtmlReport& page) {
    Plot plot{"Spectral density: " + group.title, "frequency [Hz]", "density [(" + group.unit.name + ")²/Hz]", {}};
    plot.log_y = true;
    for (const std::size_t i : group.members) {
        const Spectrum spectrum = thinOut(inspection.channels[i].spectrum);
        Series series{inspection.channels[i].name, {}, {}};
        for (Eigen::Index k = 1; k < spectrum.frequency.size(); ++k) {
            series.x.push_back(spectrum.frequency[k]);
            series.y.push_back(group.unit.factor * group.unit.factor * spectrum.density[k]);
        }
        plot.series.push_back(std::move(series));
    }
    page.addPlot(plot);
}

}  // namespace

std::string formatInspection(const Inspection& inspection, const Recording& recording, TextStyle style) {
    std::ostringstream text;
    text << describeRecording(inspection, recording) << "\n\n" << makeTable(inspection).format(style) << "\n";
    for (const auto& line : makeSentences(inspection, recording))
        text << (isWarning(line) ? paint(line, Colour::yellow, style) : line) << "\n";
    text << "\n";
    return text.str();
}

InspectReport::InspectReport() : page_(std::make_unique<HtmlReport>("Recordings")) {}
InspectReport::~InspectReport() = default;

void InspectReport::add(const Inspection& inspection, const Recording& recording) {
    page_->addHeading(recording.file);
    page_->addText(describeRecording(inspection, recording));
    const Table table = makeTable(inspection);
    page_->addList(makeSentences(inspection, recording));
    page_->addTable(table.header(), table.rows());
    std::vector<std::pair<std::string, std::string>> names;
    for (const ChannelStatistics& channel : inspection.channels) names.emplace_back(channel.name, channel.unit);
    const auto groups = groupChannels(names);
    for (const ChannelGroup& group : groups)
        if (!inspection.orders.tracks.empty()) addOrderPlots(inspection, group, *page_);
    for (const ChannelGroup& group : groups) addSpectra(inspection, group, *page_);
}

void InspectReport::write(const std::string& file, OutputFiles& outputs) const {
    page_->write(file, outputs);
}

}  // namespace wems::identify::commands
