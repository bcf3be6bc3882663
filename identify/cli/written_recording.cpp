#include "identify/cli/written_recording.hpp"

#include <utility>

#include "identify/commands/channel_groups.hpp"
#include "models/format_number.hpp"

namespace wems::identify::cli {
namespace {

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

}  // namespace

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

}  // namespace wems::identify::cli
