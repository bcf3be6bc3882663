// What is in a recording, what is suspicious, what can be identified from it.
#include "identify/commands/inspect.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/commands/inspect_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/inspect/quality.hpp"
#include "models/recording/recording_stream.hpp"

namespace wems::identify::commands {
namespace {

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

nlohmann::json makeOrderListJson(const OrderTracking& orders) {
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

nlohmann::json makeInspectionJson(const Inspection& inspection, const Recording& recording) {
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
            {"orders", makeOrderListJson(inspection.orders)},
            {"findings", findings},
            {"abilities", inspection.abilities},
            {"notes", inspection.notes},
            {"quality", makeQualityJson(inspection.quality)},
            {"warnings", recording.warnings}};
}

/// Block by block. `header` gets what stands before the data.
Inspection inspectStream(const std::string& file, const ColumnMap* map, const MountModel* model, Recording& header,
                         Watcher& watcher) {
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
        watcher.onProgress(stream.fractionRead(), "blocks of " + file);
    }
    Inspection inspection = inspector.finish();
    header.warnings = warnings.list();
    header.warnings.push_back("read in " + std::to_string(inspection.blocks) + " blocks of " +
                              std::to_string(block_rows) + " rows");
    return inspection;
}

/// @param recording its values are left out where it is long
Inspection inspectOne(const InspectRequest& request, const RecordingSource& source, const ColumnMap* map,
                      const MountModel* model, Recording& recording, Watcher& watcher) {
    const std::string& file = source.file;
    // Of the recording, its uniform copy, what is found in it, the rigid motions; measured.
    const double bytes_a_value = model != nullptr ? 65 : 30;
    const auto size = estimateSize({source}, map);
    if (size && bytes_a_value * size->samples * size->channels > 1e6 * request.memory.megabytes)
        return inspectStream(file, map, model, recording, watcher);
    watcher.onStep({"reading " + file});
    recording = readSource(source, map);
    watcher.onStep({"looking at " + file, 0.25});
    for (std::string& sentence : findContradictions(recording)) recording.warnings.push_back(std::move(sentence));
    return inspect(recording, model);
}

}  // namespace

bool InspectAnswer::hasFindings() const {
    return std::any_of(recordings.begin(), recordings.end(),
                       [](const InspectedRecording& one) { return !one.inspection.findings.empty(); });
}

InspectAnswer runInspect(const InspectRequest& request, Watcher& watcher) {
    InspectAnswer answer;
    answer.record = beginRecord("inspect");
    answer.record.options = {{"memory_MB", request.memory.megabytes}};
    const DeviceInputs inputs =
        readInputs(request.model, request.columns, request.geometry, request.recordings, answer.record, watcher);
    for (const RecordingSource& source : request.recordings) {
        InspectedRecording& one = answer.recordings.emplace_back();
        one.inspection = inspectOne(request, source, inputs.findMap(), inputs.findModel(), one.recording, watcher);
        one.recording.time = {};
        for (Channel& channel : one.recording.channels) channel.values = {};
    }
    return answer;
}

nlohmann::json toJson(const InspectAnswer& answer) {
    auto results = nlohmann::json::array();
    for (const InspectedRecording& one : answer.recordings)
        results.push_back(makeInspectionJson(one.inspection, one.recording));
    nlohmann::json result = {{"recordings", results}};
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const InspectAnswer& answer, TextStyle style) {
    std::string text;
    for (const InspectedRecording& one : answer.recordings)
        text += formatInspection(one.inspection, one.recording, style);
    return text;
}

void writeReport(const InspectAnswer& answer, const std::string& file, OutputFiles& outputs) {
    InspectReport report;
    for (const InspectedRecording& one : answer.recordings) report.add(one.inspection, one.recording);
    report.write(file, outputs);
}

}  // namespace wems::identify::commands
