#include "identify/commands/level_overlay.hpp"

#include <algorithm>
#include <cmath>

#include "identify/commands/spectra_output.hpp"

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

}  // namespace wems::identify::commands
