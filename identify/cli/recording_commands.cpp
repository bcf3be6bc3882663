// identify convert, identify merge: a recording is written, as data and as a page with its channels over time.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/cli/command.hpp"
#include "identify/commands/inspect_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/merge/merge.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/progress.hpp"
#include "models/recording/recording.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {

namespace {

struct WrittenRecording {
    const Recording& recording;
    std::string file;                ///< as which it was written
    std::string made;                ///< one line: what it was made of
    std::vector<std::string> notes;  ///< what was noticed on the way
};

nlohmann::json makeRecordingJson(const WrittenRecording& written) {
    const Recording& recording = written.recording;
    auto channels = nlohmann::json::array();
    for (const Channel& channel : recording.channels)
        channels.push_back({{"name", channel.name}, {"unit", channel.unit}});
    return {{"file", written.file},
            {"samples", recording.sampleCount()},
            {"rate", numberOrNull(1 / recording.sampleInterval())},
            {"from", recording.time.front()},
            {"to", recording.time.back()},
            {"channels", channels},
            {"unused_columns", recording.unused_columns},
            {"notes", written.notes}};
}

void addChannels(HtmlReport& page, const Recording& recording) {
    std::vector<std::pair<std::string, std::string>> names;
    for (const Channel& channel : recording.channels) names.emplace_back(channel.name, channel.unit);
    for (const ChannelGroup& group : groupChannels(names)) {
        Plot plot{group.title, "time [s]", "[" + group.unit.name + "]", {}};
        for (const std::size_t i : group.members) {
            Series series{recording.channels[i].name, recording.time, recording.channels[i].values};
            for (double& value : series.y) value *= group.unit.factor;
            plot.series.push_back(std::move(series));
        }
        page.addPlot(plot);
    }
}

/// --json and --report, if they were asked for.
/// @param record of the command
/// @param pictures that come before those of the channels
void reportWritten(const WrittenRecording& written, const ResultRecord& record, const std::vector<Plot>& pictures,
                   const CommonOptions& options, OutputFiles& outputs) {
    if (!options.json_file.empty()) {
        nlohmann::json data = makeRecordingJson(written);
        addRecord(data, record);
        writeJson(data, options, outputs);
    }
    if (options.report_file.empty()) return;
    HtmlReport page("Recording: " + written.file);
    page.addText(written.made);
    page.addList(written.notes);
    if (!written.recording.unused_columns.empty()) {
        page.addHeading("Columns that are no channels");
        page.addText(joinWords(written.recording.unused_columns, ", "));
    }
    for (const Plot& plot : pictures) page.addPlot(plot);
    page.addHeading("Channels");
    addChannels(page, written.recording);
    page.write(options.report_file, outputs);
}

}  // namespace

// identify convert: a recording from any format that is read to any that is written.

namespace {

struct ConvertOptions {
    CommonOptions common;
    std::string input, output, model;
    int digits = 9;
};

void runConvert(const ConvertOptions& options) {
    OutputFiles outputs;
    WriteOptions write;
    write.digits = options.digits;
    if (!options.model.empty()) {
        const MountModel model = readMountModel(options.model);
        protectInputs({model.bracket_path}, options.output, options.common, outputs);
        for (const Connection& connection : model.connections) write.rest[connection.name] = connection.position;
    }
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    progress->step({"reading " + options.input});
    const std::optional<ColumnMap> map = readOptionalMap(options.common.column_map);
    const Recording recording = readRecording(options.input, map ? &*map : nullptr);
    progress->step({"writing " + options.output, 0.55});
    const auto notes = writeRecording(recording, options.output, write, outputs);
    progress.reset();
    for (const auto& warning : recording.warnings)
        std::cerr << "identify: " << recording.file << ": " << warning << "\n";
    for (const auto& note : notes) std::cerr << "identify: " << options.output << ": " << note << "\n";
    const std::string made = std::to_string(recording.channels.size()) + " channels, " +
                             std::to_string(recording.sampleCount()) + " samples from " + recording.format;
    std::vector<std::string> noticed = recording.warnings;
    noticed.insert(noticed.end(), notes.begin(), notes.end());
    ResultRecord record = beginRecord("convert");
    record.addInput("model", options.model);
    record.addInput("columns", options.common.column_map);
    record.addInput("recording", options.input);
    record.options = {{"digits", options.digits}};
    if (map) record.addColumns(*map);
    reportWritten({recording, options.output, options.input + ": " + made, noticed}, record, {}, options.common,
                  outputs);
    if (options.common.printsText()) {
        std::cout << options.output << ": " << made << "\n";
        if (!recording.unused_columns.empty())
            std::cout << "not a channel: '" << joinWords(recording.unused_columns, "' '") << "'\n";
    }
    finishOutput(outputs);
}

}  // namespace

void addConvertCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("convert", "Turn a recording into another format");
    auto options = std::make_shared<ConvertOptions>();
    addInputFile(*command, "input", options->input, std::string("recording (") + kReadableFormats + ")")->required();
    addOutputFile(*command, "output", options->output, ".csv, .trc, .sto or .mot")->required();
    addInputFile(*command, "--model", options->model, "mount model: markers in .trc stand where its connections are");
    command->add_option("--digits", options->digits, "significant digits of values (default 9)")
        ->check(CLI::Range(1, 17));
    addCommonOptions(*command, options->common);
    command->footer("Example:\n  identify convert shaker.mat run.csv --columns map.toml");
    command->callback([options] { runConvert(*options); });
}

// identify merge: recordings of one run made by several systems as one recording.

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
        progress->step({"reading " + options.inputs[i],
                        share_of_reading * static_cast<double>(i) / static_cast<double>(options.inputs.size())});
        recordings.push_back(readRecording(options.inputs[i], map ? &*map : nullptr));
    }
    progress->step({"putting them together", share_of_reading});
    const MergedRecording result = merge(recordings, options.merge);
    const Recording& merged = result.recording;
    progress->step({"writing " + options.output, 1 - share_of_writing});
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
