// Errors of a simulated recording, channel by channel, by frequency band and by regime.
#include "identify/commands/compare.hpp"

#include <cmath>
#include <optional>

#include "identify/commands/compare_pictures.hpp"
#include "identify/commands/format.hpp"
#include "identify/commands/recordings.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {
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
    watcher.onStep("reading " + answer.measured, 0, 1);
    const Recording measured = readSource(request.measured, inputs.findMap());
    watcher.onStep("reading " + answer.simulated, share_of_reading / 2, 1);
    const Recording simulated = readSource(request.simulated, map ? &*map : nullptr);
    watcher.onStep("comparing", share_of_reading, 1);
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
