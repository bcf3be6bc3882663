// identify inspect: what is in a recording, what is suspicious, what can be identified from it.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "identify/cli/command.hpp"
#include "identify/cli/inspect_report.hpp"
#include "identify/cli/long_recordings.hpp"
#include "identify/cli/quality_output.hpp"
#include "identify/cli/recordings.hpp"
#include "identify/inspect/derivative_check.hpp"
#include "identify/inspect/inspection.hpp"
#include "models/command_line/usage.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_stream.hpp"

namespace wems::identify::cli {
namespace {

struct InspectOptions {
    CommonOptions common;
    std::vector<std::string> recordings;
    std::string model;
    MemoryOption memory;
    bool strict = false;
};

nlohmann::json makeChannelJson(const ChannelStatistics& channel) {
    return {{"name", channel.name},
            {"unit", channel.unit},
            {"rms", channel.rms},
            {"mean", channel.mean},
            {"lowest", channel.lowest},
            {"highest", channel.highest},
            {"noise", numberOrNull(channel.noise)},
            {"signal_to_noise_db", numberOrNull(channel.signal_to_noise)},
            {"band", {channel.band_from, channel.band_to}}};
}

nlohmann::json makeOrdersJson(const OrderTracking& orders) {
    auto tracks = nlohmann::json::array();
    for (const OrderTrack& track : orders.tracks) {
        auto list = nlohmann::json::array();
        for (int order = 0; order < tracked_orders; ++order) {
            auto amplitude = nlohmann::json::array(), phase = nlohmann::json::array();
            for (Eigen::Index p = 0; p < track.amplitude.cols(); ++p) {
                amplitude.push_back(numberOrNull(track.amplitude(order, p)));
                phase.push_back(numberOrNull(track.phase(order, p)));
            }
            list.push_back({{"order", order + 1}, {"amplitude", amplitude}, {"phase", phase}});
        }
        tracks.push_back({{"channel", track.channel}, {"orders", list}});
    }
    return {{"time", orders.time}, {"frequency", orders.hertz}, {"reference", orders.reference}, {"channels", tracks}};
}

nlohmann::json makeJson(const Inspection& inspection, const Recording& recording) {
    auto channels = nlohmann::json::array(), findings = nlohmann::json::array();
    for (const ChannelStatistics& channel : inspection.channels) channels.push_back(makeChannelJson(channel));
    for (const Finding& finding : inspection.findings)
        findings.push_back({{"kind", kindName(finding.kind)},
                            {"channel", finding.channel},
                            {"row", finding.row},
                            {"time", finding.time},
                            {"message", finding.message}});
    const SweptFrequency& swept = inspection.swept;
    return {{"file", recording.file},
            {"format", recording.format},
            {"samples", inspection.samples},
            {"blocks", inspection.blocks},
            {"rate", inspection.rate},
            {"duration", inspection.duration},
            {"drive",
             {{"source", swept.source},
              {"is_sine", swept.is_sine},
              {"tones", swept.tones},
              {"band", {swept.lowest, swept.highest}}}},
            {"metadata", recording.metadata},
            {"unused_columns", recording.unused_columns},
            {"channels", channels},
            {"orders", makeOrdersJson(inspection.orders)},
            {"findings", findings},
            {"abilities", inspection.abilities},
            {"notes", inspection.notes},
            {"quality", makeQualityJson(inspection.quality)},
            {"warnings", recording.warnings}};
}

/// Block by block. `header` gets what stands before the data.
Inspection inspectStream(const std::string& file, const ColumnMap* map, const MountModel* model, Recording& header,
                         Progress& progress) {
    RecordingStream stream(file, map, block_rows);
    header = stream.header();
    Inspector inspector(model);
    BlockNotes warnings;
    Recording block;
    while (stream.next(block)) {
        for (const auto& warning : block.warnings) {
            const bool found = std::any_of(block.findings.begin(), block.findings.end(),
                                           [&](const Finding& finding) { return finding.message == warning; });
            if (!found) warnings.add(warning);
        }
        inspector.add(block);
        progress.show(stream.fractionRead(), "blocks of " + file);
    }
    Inspection inspection = inspector.finish();
    header.warnings = warnings.list();
    header.warnings.push_back("read in " + std::to_string(inspection.blocks) + " blocks of " +
                              std::to_string(block_rows) + " rows");
    return inspection;
}

/// @param recording its values are left out where it is long
Inspection inspectOne(const InspectOptions& options, const std::string& file, const ColumnMap* map,
                      const MountModel* model, Recording& recording) {
    Progress progress(!options.common.quiet);
    // Of the recording, its uniform copy, what is found in it, the rigid motions; measured.
    const double bytes_a_value = model != nullptr ? 65 : 30;
    const auto size = estimateSize({file}, map);
    if (size && bytes_a_value * size->samples * size->channels > 1e6 * options.memory.megabytes)
        return inspectStream(file, map, model, recording, progress);
    progress.step("reading " + file);
    recording = readRecording(file, map);
    progress.step("looking at " + file, 0.25);
    for (std::string& sentence : findContradictions(recording)) recording.warnings.push_back(std::move(sentence));
    return inspect(recording, model);
}

void runInspect(const InspectOptions& options, int& exit_status) {
    OutputFiles outputs;
    std::optional<MountModel> model;
    if (!options.model.empty()) model = readDeviceModel(options.model, options.common.geometry);
    if (model) protectInputs({model->bracket_path}, "", options.common, outputs);
    const std::optional<ColumnMap> map =
        model ? readDeviceMap(options.common.column_map, *model) : readOptionalMap(options.common.column_map);
    auto results = nlohmann::json::array();
    InspectReport report;
    for (const std::string& file : options.recordings) {
        Recording recording;
        const Inspection inspection =
            inspectOne(options, file, map ? &*map : nullptr, model ? &*model : nullptr, recording);
        if (options.common.printsText()) std::cout << formatInspection(inspection, recording, outputStyle());
        results.push_back(makeJson(inspection, recording));
        if (!options.common.report_file.empty()) report.add(inspection, recording);
        if (options.strict && !inspection.findings.empty()) exit_status = 1;
    }
    writeJson({{"recordings", results}}, options.common, outputs);
    if (!options.common.report_file.empty()) report.write(options.common.report_file, outputs);
    finishOutput(outputs);
}

}  // namespace

void addInspectCommand(CLI::App& app, int& exit_status) {
    auto* command = app.add_subcommand("inspect", "Show what is in recordings and what is suspicious about them");
    auto options = std::make_shared<InspectOptions>();
    addInputFile(*command, "recordings", options->recordings, std::string("recordings (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "--model", options->model, "mount model: also finds missing and exchanged connections");
    command->add_flag("--strict", options->strict, "exit status 1 if anything is suspicious");
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    addMemoryOption(*command, options->memory);
    command->footer("Example:\n  identify inspect run1.csv run2.mat --model mount.toml --report runs.html");
    command->callback([options, &exit_status] { runInspect(*options, exit_status); });
}

}  // namespace wems::identify::cli
