// Frequency responses, densities, orders, shock response and margins of recordings.
#include "identify/commands/spectra.hpp"

#include <optional>

#include "identify/commands/recordings.hpp"
#include "identify/commands/spectra_output.hpp"

namespace wems::identify::commands {

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
        watcher.onStep("spectra of " + source.file, 0, 1);
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
