// Frequency responses, densities, orders, shock response and margins of recordings.
#include "identify/commands/spectra.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/commands/recordings.hpp"
#include "identify/commands/spectra_report.hpp"
#include "identify/spectra/welch.hpp"

namespace wems::identify::commands {

namespace {

std::vector<double> listOf(const Eigen::VectorXd& values) {
    return {values.begin(), values.end()};
}

nlohmann::json listFinite(const Eigen::VectorXd& values) {
    auto list = nlohmann::json::array();
    for (const double value : values) list.push_back(numberOrNull(value));
    return list;
}

nlohmann::json makeComplex(const Eigen::VectorXcd& values) {
    return {{"real", listFinite(values.real())}, {"imaginary", listFinite(values.imag())}};
}

nlohmann::json makeTransferJson(const ChannelTransfer& transfer) {
    auto peaks = nlohmann::json::array();
    for (const ResponsePeak& peak : transfer.peaks)
        peaks.push_back({{"frequency", peak.frequency},
                         {"amplitude", peak.amplitude},
                         {"interval95_radius", numberOrNull(transfer.estimate.radius95[peak.bin])},
                         {"damping_ratio", numberOrNull(peak.damping_ratio)},
                         {"coherence", numberOrNull(transfer.estimate.coherence[peak.bin])}});
    return {{"input", transfer.input},
            {"output", transfer.output},
            {"unit", transfer.unit},
            {"h1", makeComplex(transfer.estimate.h1)},
            {"h2", makeComplex(transfer.estimate.h2)},
            {"hv", makeComplex(transfer.estimate.hv)},
            {"coherence", listFinite(transfer.estimate.coherence)},
            {"interval95_radius", listFinite(transfer.estimate.radius95)},
            {"peaks", peaks}};
}

nlohmann::json makeOrdersJson(const OrderTracking& orders) {
    auto tracks = nlohmann::json::array();
    for (const OrderTrack& track : orders.tracks) {
        auto amplitude = nlohmann::json::array(), phase = nlohmann::json::array();
        for (Eigen::Index order = 0; order < track.amplitude.rows(); ++order) {
            amplitude.push_back(listFinite(track.amplitude.row(order).transpose()));
            phase.push_back(listFinite(track.phase.row(order).transpose()));
        }
        tracks.push_back({{"channel", track.channel}, {"amplitude", amplitude}, {"phase", phase}});
    }
    return {{"reference", orders.reference}, {"frequency", orders.hertz}, {"time", orders.time}, {"tracks", tracks}};
}

nlohmann::json makeMarginsJson(const Margins& margins) {
    auto connections = nlohmann::json::array();
    for (const ConnectionMargin& margin : margins.connections) {
        nlohmann::json entry = {
            {"name", margin.name}, {"lowest", margin.lowest}, {"highest", margin.highest}, {"rms", margin.rms}};
        if (margin.largest_force) entry["largest_force"] = *margin.largest_force;
        if (margin.left_negative) entry["clearance_left_negative"] = *margin.left_negative;
        if (margin.left_positive) entry["clearance_left_positive"] = *margin.left_positive;
        connections.push_back(entry);
    }
    return {{"connections", connections}, {"notes", margins.notes}};
}

std::string formatMillimetres(const std::optional<double>& value) {
    return value ? formatNumber(1e3 * *value, 4) : std::string("-");
}

}  // namespace

SpectrumUnit findSpectrumUnit(Quantity quantity) {
    constexpr double g = 9.80665;
    if (quantity == Quantity::acceleration) return {"g", 1 / g};
    if (quantity == Quantity::length) return {"mm", 1e3};
    return {siUnit(quantity), 1};
}

Table tabulateLevels(const RunSpectra& run) {
    const bool swept = std::any_of(run.channels.begin(), run.channels.end(),
                                   [](const ChannelLevel& level) { return std::isfinite(level.at_hertz); });
    std::vector<std::string> header{"channel", "RMS", "peak", "unit", "at [s]"};
    if (swept) header.emplace_back("at [Hz]");
    Table table(header);
    for (const ChannelLevel& level : run.channels) {
        if (level.peak == 0) continue;
        const SpectrumUnit unit = findSpectrumUnit(level.quantity);
        std::vector<std::string> row{level.name, formatNumber(unit.factor * level.rms, 4),
                                     formatNumber(unit.factor * level.peak, 4), unit.name, formatNumber(level.at, 5)};
        if (swept) row.push_back(std::isfinite(level.at_hertz) ? formatNumber(level.at_hertz, 4) : "-");
        table.addRow(row);
    }
    return table;
}

Table tabulatePeaks(const std::vector<ChannelTransfer>& transfers) {
    constexpr std::size_t most = 3;  // of each
    Table table({"response", "peak at [Hz]", "amplification", "+-", "unit", "damping [%]", "coherence"});
    for (const ChannelTransfer& transfer : transfers)
        for (std::size_t i = 0; i < std::min(most, transfer.peaks.size()); ++i) {
            const ResponsePeak& peak = transfer.peaks[i];
            table.addRow({transfer.output + "/" + transfer.input, formatNumber(peak.frequency, 4),
                          formatNumber(peak.amplitude, 4), formatNumber(transfer.estimate.radius95[peak.bin], 2),
                          transfer.unit, formatNumber(100 * peak.damping_ratio, 3),
                          formatNumber(transfer.estimate.coherence[peak.bin], 4)});
        }
    return table;
}

Table tabulateMargins(const Margins& margins) {
    Table table(
        {"connection", "stroke - [mm]", "stroke + [mm]", "RMS [mm]", "force [N]", "left - [mm]", "left + [mm]"});
    for (const ConnectionMargin& margin : margins.connections)
        if (margin.lowest != margin.highest)
            table.addRow({margin.name, formatNumber(1e3 * margin.lowest, 4), formatNumber(1e3 * margin.highest, 4),
                          formatNumber(1e3 * margin.rms, 4),
                          margin.largest_force ? formatNumber(*margin.largest_force, 4) : std::string("-"),
                          formatMillimetres(margin.left_negative), formatMillimetres(margin.left_positive)});
    return table;
}

std::string formatSpectra(const std::vector<RunSpectra>& runs, TextStyle style) {
    std::string text;
    if (const auto overlay = makeLevelOverlay(runs))
        text += describeLevels(*overlay) + "\n\n" + tabulateLevels(*overlay).format(style);
    for (const RunSpectra& run : runs) {
        if (!text.empty()) text += "\n";
        text += run.file + ": " + formatNumber(run.spectra.resolution, 4) + " Hz resolution, " +
                std::to_string(run.spectra.segments) + " segments, " + formatNumber(run.spectra.degrees_of_freedom, 3) +
                " degrees of freedom";
        if (!run.reference.empty())
            text += "; driven by " + run.reference + ", " + formatNumber(run.lowest, 4) + " to " +
                    formatNumber(run.highest, 4) + " Hz";
        text += "\n\n" + tabulateLevels(run).format(style);
        const Table transmissibility = tabulatePeaks(run.transmissibilities), response = tabulatePeaks(run.transfers);
        if (!transmissibility.empty()) text += "\ntransmissibility\n" + transmissibility.format(style);
        if (!response.empty()) text += "\nfrequency response\n" + response.format(style);
        if (!run.margins.connections.empty()) text += "\n" + tabulateMargins(run.margins).format(style);
        for (const auto& note : run.notes) text += "note: " + note + "\n";
        for (const auto& note : run.margins.notes) text += "note: " + note + "\n";
    }
    return text;
}

nlohmann::json makeSpectraJson(const std::vector<RunSpectra>& runs) {
    auto list = nlohmann::json::array();
    for (const RunSpectra& run : runs) {
        const DensityInterval interval = densityInterval95(run.spectra.degrees_of_freedom);
        auto channels = nlohmann::json::array(), transfers = nlohmann::json::array(), ratios = transfers,
             shocks = transfers;
        for (std::size_t c = 0; c < run.channels.size(); ++c) {
            const ChannelLevel& level = run.channels[c];
            const std::string unit = siUnit(level.quantity);
            channels.push_back({{"name", level.name},
                                {"unit", unit},
                                {"rms", level.rms},
                                {"peak", level.peak},
                                {"peak_time", level.at},
                                {"peak_frequency", numberOrNull(level.at_hertz)},
                                {"density", listOf(run.spectra.density.col(c))},
                                {"density_unit", "(" + unit + ")^2/Hz"}});
            if (level.quantity == Quantity::acceleration)
                channels.back()["g_rms"] = findSpectrumUnit(level.quantity).factor * level.rms;
        }
        for (const ChannelTransfer& transfer : run.transfers) transfers.push_back(makeTransferJson(transfer));
        for (const ChannelTransfer& transfer : run.transmissibilities) ratios.push_back(makeTransferJson(transfer));
        for (std::size_t i = 0; i < run.shocks.size(); ++i)
            shocks.push_back({{"channel", run.shock_channels[i]},
                              {"frequency", run.shocks[i].frequency},
                              {"positive", listOf(run.shocks[i].positive)},
                              {"negative", listOf(run.shocks[i].negative)},
                              {"maximax", listOf(run.shocks[i].maximax)}});
        list.push_back({{"file", run.file},
                        {"reference", run.reference},
                        {"band", {run.lowest, run.highest}},
                        {"frequency", listOf(run.spectra.frequency)},
                        {"resolution", run.spectra.resolution},
                        {"segments", run.spectra.segments},
                        {"degrees_of_freedom", run.spectra.degrees_of_freedom},
                        {"density_interval95_factors", {interval.lower, interval.upper}},
                        {"channels", channels},
                        {"transfer", transfers},
                        {"transmissibility", ratios},
                        {"orders", makeOrdersJson(run.orders)},
                        {"shock_response", shocks},
                        {"margins", makeMarginsJson(run.margins)},
                        {"notes", run.notes}});
    }
    return {{"runs", list}};
}

SpectraAnswer runSpectra(const SpectraRequest& request, Watcher& watcher) {
    SpectraAnswer answer;
    answer.record = beginRecord("spectra");
    const SpectraSettings& settings = request.settings;
    answer.record.options = {{"reference", settings.reference}, {"q", settings.quality}};
    if (settings.resolution) answer.record.options["resolution"] = *settings.resolution;
    if (settings.band) answer.record.options["band"] = {settings.band->first, settings.band->second};
    const DeviceInputs inputs =
        readInputs(request.model, request.columns, request.geometry, request.recordings, answer.record, watcher);
    for (const RecordingSource& source : request.recordings) {
        watcher.onStep({"spectra of " + source.file});
        const Recording recording = readSource(source, inputs.findMap());
        for (const auto& warning : recording.warnings) answer.warnings.push_back(source.file + ": " + warning);
        answer.runs.push_back(calcRunSpectra(recording, inputs.findModel(), settings));
    }
    return answer;
}

nlohmann::json toJson(const SpectraAnswer& answer) {
    nlohmann::json result = makeSpectraJson(answer.runs);
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const SpectraAnswer& answer, TextStyle style) {
    return formatSpectra(answer.runs, style);
}

void writeReport(const SpectraAnswer& answer, const std::string& file, OutputFiles& outputs) {
    writeSpectraReport(answer.runs, file, outputs);
}

}  // namespace wems::identify::commands
