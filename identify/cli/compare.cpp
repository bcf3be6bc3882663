// identify compare: errors of a simulated recording, channel by channel, by frequency band and by regime.
#include "identify/forward/compare.hpp"

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/cli/command.hpp"
#include "identify/cli/compare_pictures.hpp"
#include "identify/cli/recordings.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"
#include "models/mount_model.hpp"
#include "models/progress.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

constexpr double kLeastShareDrawn = 1e-3;  // of a channel in the error

struct CompareOptions {
    CommonOptions common;
    std::string measured, simulated, model;
    double limit = 0;
};

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

void writeReport(const Comparison& comparison, const CompareOptions& options, OutputFiles& outputs) {
    HtmlReport page("Comparison of " + options.simulated + " with " + options.measured);
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
    page.write(options.common.report_file, outputs);
}

/// @param[out] warnings about the recordings
Comparison runComparison(const CompareOptions& options, Progress& progress, std::vector<std::string>& warnings) {
    std::optional<MountModel> model;
    if (!options.model.empty()) model = readDeviceModel(options.model, options.common.geometry);
    const std::optional<ColumnMap> map = readOptionalMap(options.common.column_map);
    const std::optional<ColumnMap> laboratory = model ? readDeviceMap(options.common.column_map, *model) : map;
    const double share_of_reading = model ? 0.5 : 0.9;
    progress.step("reading " + options.measured);
    const Recording measured = readRecording(options.measured, laboratory ? &*laboratory : nullptr);
    progress.step("reading " + options.simulated, share_of_reading / 2);
    const Recording simulated = readRecording(options.simulated, map ? &*map : nullptr);
    progress.step("comparing", share_of_reading);
    for (const auto* recording : {&measured, &simulated})
        for (const auto& warning : recording->warnings) warnings.push_back(recording->file + ": " + warning);
    if (!model) {
        Comparison comparison =
            compare(calcRelativeDisplacement(measured), calcRelativeDisplacement(simulated), nullptr);
        comparison.notes.emplace_back(
            "without --model the difference of both ends' displacements is compared as it stands; with it, in the axes "
            "of the fixed part as they turn");
        return comparison;
    }
    return compare(calcRelativeDisplacement(measured, *model), calcRelativeDisplacement(simulated, *model), &*model);
}

}  // namespace

void addCompareCommand(CLI::App& app, int& exit_status) {
    auto* command = app.add_subcommand("compare", "Errors of a simulated recording against a measured one");
    auto options = std::make_shared<CompareOptions>();
    addInputFile(*command, "measured", options->measured,
                 std::string("recording of the test (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "simulated", options->simulated, "recording of the simulation")->required();
    addInputFile(*command, "--model", options->model,
                 "mount model: exact relative displacements, and errors free and in contact apart");
    command->add_option("--limit", options->limit, "exit status 1 if the error exceeds this fraction, such as 0.05")
        ->check(isPositive());
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer("Example:\n  identify compare measured.csv simulated.csv --model mount.toml --limit 0.05");
    command->callback([options, command, &exit_status] {
        std::optional<Progress> progress(std::in_place, !options->common.quiet);
        std::vector<std::string> warnings;
        const Comparison comparison = runComparison(*options, *progress, warnings);
        progress.reset();
        for (const auto& warning : warnings) std::cerr << "identify: " << warning << "\n";
        if (options->common.printsText()) {
            std::cout << describeError(comparison) << "\n\n" << makeTable(comparison).format(outputStyle());
            for (const auto& note : comparison.notes) std::cout << "note: " << note << "\n";
        }
        OutputFiles outputs;
        writeJson(formatComparison(comparison), options->common, outputs);
        if (!options->common.report_file.empty()) writeReport(comparison, *options, outputs);
        finishOutput(outputs);
        const bool exceeded = command->count("--limit") > 0 && !(comparison.error <= options->limit);
        if (exceeded) {
            std::cerr << "identify: the error " << formatNumber(comparison.error, 4) << " exceeds the limit "
                      << formatNumber(options->limit, 4) << "\n";
            exit_status = 1;
        }
    });
}

}  // namespace wems::identify::cli
