// identify convert: a recording from any format that is read to any that is written.
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/cli/written_recording.hpp"
#include "identify/commands/recordings.hpp"
#include "models/command_line/usage.hpp"
#include "models/format_number.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"

namespace wems::identify::cli {
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
    progress->step("reading " + options.input);
    const std::optional<ColumnMap> map = readOptionalMap(options.common.column_map);
    const Recording recording = readRecording(options.input, map ? &*map : nullptr);
    progress->step("writing " + options.output, 0.55);
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

}  // namespace wems::identify::cli
