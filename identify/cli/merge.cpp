// identify merge: recordings of one run made by several systems as one recording.
#include "identify/merge/merge.hpp"

#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/cli/written_recording.hpp"
#include "identify/commands/channel_groups.hpp"
#include "identify/commands/recordings.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"

namespace wems::identify::cli {
namespace {

struct MergeCommandOptions {
    std::vector<std::string> inputs, maps;
    std::string output;
    MergeOptions merge;
    CommonOptions common;
};

/// The common channel as each recording has it, aligned.
std::vector<Plot> plotCommon(const MergedRecording& merged, const std::string& name) {
    if (merged.common.empty()) return {};
    const Channel* channel = merged.recording.find(name);
    const ShownUnit unit = showUnit(channel != nullptr ? channel->unit : "");
    Plot plot{
        "Common channel " + name + " after alignment", "time of the first recording [s]", "[" + unit.name + "]", {}};
    for (const AlignedChannel& aligned : merged.common) {
        Series series{aligned.file, {}, aligned.signal.values};
        for (std::size_t k = 0; k < series.y.size(); ++k) {
            series.x.push_back(aligned.signal.start + static_cast<double>(k) * aligned.signal.interval);
            series.y[k] *= unit.factor;
        }
        plot.series.push_back(std::move(series));
    }
    return {plot};
}

void runMerge(const MergeCommandOptions& options) {
    if (!options.maps.empty() && options.maps.size() != 1 && options.maps.size() != options.inputs.size())
        throw InputError({"", 0, "--columns"}, "there are " + std::to_string(options.maps.size()) + " column maps",
                         "one for all recordings, or one for each");
    constexpr double share_of_reading = 0.35, share_of_writing = 0.3;
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    OutputFiles outputs;
    std::vector<Recording> recordings;
    for (std::size_t i = 0; i < options.inputs.size(); ++i) {
        const std::string file = options.maps.empty() ? "" : options.maps[options.maps.size() == 1 ? 0 : i];
        const std::optional<ColumnMap> map = readOptionalMap(file);
        progress->step("reading " + options.inputs[i],
                       share_of_reading * static_cast<double>(i) / static_cast<double>(options.inputs.size()));
        recordings.push_back(readRecording(options.inputs[i], map ? &*map : nullptr));
    }
    progress->step("putting them together", share_of_reading);
    const MergedRecording result = merge(recordings, options.merge);
    const Recording& merged = result.recording;
    progress->step("writing " + options.output, 1 - share_of_writing);
    const auto notes = writeRecording(merged, options.output, {}, outputs);
    progress.reset();
    for (const Recording& recording : recordings)
        for (const auto& warning : recording.warnings) std::cerr << recording.file << ": " << warning << "\n";
    for (const auto& note : notes) std::cerr << "identify: " << note << "\n";
    const std::string made =
        std::to_string(merged.channels.size()) + " channels, " + std::to_string(merged.sampleCount()) + " samples at " +
        formatNumber(1 / merged.sampleInterval(), 6) + " Hz from " + formatNumber(merged.time.front(), 6) + " s";
    ResultRecord record = beginRecord("merge");
    for (const std::string& file : options.maps) record.addInput("columns", file);
    for (const std::string& file : options.inputs) record.addInput("recording", file);
    record.options = {{"common", options.merge.common}, {"rate", options.merge.rate}};
    std::vector<std::string> noticed = merged.warnings;
    noticed.insert(noticed.end(), notes.begin(), notes.end());
    reportWritten({merged, options.output, joinWords(options.inputs, ", ") + ": " + made, noticed}, record,
                  plotCommon(result, options.merge.common), options.common, outputs);
    if (options.common.printsText()) {
        for (const auto& note : merged.warnings) std::cout << note << "\n";
        std::cout << options.output << ": " << made << "\n";
    }
    finishOutput(outputs);
}

}  // namespace

void addMergeCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("merge", "Put recordings of one run by several systems together");
    auto options = std::make_shared<MergeCommandOptions>();
    addInputFile(*command, "recordings", options->inputs, "recordings; the clock of the first one counts")
        ->required()
        ->expected(2, 64);
    addOutputFile(*command, "-o,--output", options->output, "recording to write: .csv, .trc, .sto, .mot")->required();
    command->add_option("--common", options->merge.common,
                        "channel that all have, such as load.fz: aligns them by correlation; absent: stamps are right");
    command->add_option("--rate", options->merge.rate, "Hz; absent: the lowest of all")->check(isPositive());
    addInputFile(*command, "--columns", options->maps, "column map for all recordings, or one for each")
        ->expected(1, 64);
    addResultOptions(*command, options->common);
    command->footer("Example:\n  identify merge shaker.csv cameras.trc -o run.csv --common fixed.1.z");
    command->callback([options] { runMerge(*options); });
}

}  // namespace wems::identify::cli
