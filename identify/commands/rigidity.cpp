// Does each part of a recording move as a rigid body?
#include "identify/commands/rigidity.hpp"

#include <algorithm>
#include <cmath>

#include "identify/commands/format.hpp"
#include "identify/commands/quality_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/commands/rigidity_report.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {
namespace {

/// The check over time and swept frequency, some 1000 samples that keep its shape.
nlohmann::json makeHistory(const Rigidity& rigidity, const RigidityCheck& check) {
    const std::vector<double> percent(check.percent.begin(), check.percent.end());
    auto time = nlohmann::json::array(), hertz = time, values = time;
    for (const std::size_t k : decimateByShape(percent, 250)) {
        time.push_back(rigidity.time[k]);
        hertz.push_back(numberOrNull(rigidity.swept.hertz(static_cast<Eigen::Index>(k))));
        values.push_back(percent[k]);
    }
    return {{"time", time}, {"frequency", hertz}, {"percent", values}};
}

nlohmann::json makeJson(const Rigidity& rigidity, const QualityVerdict& quality, const Recording& recording) {
    nlohmann::json checks = nlohmann::json::array(), suspects = nlohmann::json::array();
    for (const RigidityCheck& check : rigidity.checks) {
        checks.push_back({{"name", check.name},
                          {"max_percent", check.max_percent},
                          {"at_frequency", numberOrNull(check.at_frequency)},
                          {"at_time", check.at_time},
                          {"noise_percent", numberOrNull(check.noise_percent)},
                          {"history", makeHistory(rigidity, check)}});
    }
    for (const ChannelSuspect& suspect : rigidity.suspects) {
        nlohmann::json entry{{"channel", suspect.channel},
                             {"fault", suspect.fault},
                             {"explained", suspect.explained},
                             {"alternatives", suspect.alternatives}};
        if (suspect.fault == "gain") entry["gain"] = suspect.gain;
        if (suspect.fault == "delay") entry["delay"] = suspect.delay;
        if (suspect.fault == "exchanged") entry["exchanged_with"] = suspect.exchanged_with;
        if (suspect.fault != "exchanged") entry["standard_error"] = suspect.standard_error;
        suspects.push_back(entry);
    }
    return {{"checks", checks},
            {"suspects", suspects},
            {"notes", rigidity.notes},
            {"quality", makeQualityJson(quality)},
            {"warnings", recording.warnings}};
}

std::string describe(const ChannelSuspect& suspect) {
    std::string text = suspect.channel + ": ";
    if (suspect.fault == "gain") {
        text += "gain " + formatNumber(suspect.gain) + " ± " + formatNumber(2 * suspect.standard_error, 2);
    } else if (suspect.fault == "delay") {
        text += "late by " + formatNumber(1e3 * suspect.delay) + " ± " + formatNumber(2e3 * suspect.standard_error, 2) +
                " ms";
    } else {
        text += "exchanged with " + suspect.exchanged_with;
    }
    text += ", explains " + formatNumber(100 * suspect.explained, 3) + " % of what is not rigid";
    for (std::size_t i = 0; i < suspect.alternatives.size(); ++i)
        text += (i == 0 ? "; or instead " : ", ") + suspect.alternatives[i];
    return text;
}

Table makeTable(const Rigidity& rigidity) {
    Table table({"check", "largest [%]", "noise RMS [%]", "at [Hz]", "at [s]"});
    for (const RigidityCheck& check : rigidity.checks)
        table.addRow({check.name, formatNumber(check.max_percent, 4), formatNumber(check.noise_percent, 3),
                      formatNumber(check.at_frequency, 4), formatNumber(check.at_time)});
    return table;
}

std::vector<std::string> makeSentences(const Rigidity& rigidity, const QualityVerdict& quality,
                                       const Recording& recording) {
    std::vector<std::string> lines{
        formatVerdict(quality),
        "Lengths relative to their rest length, perpendicularity to 90 degrees, midpoints to the arm length."};
    if (rigidity.suspects.empty()) lines.emplace_back("No suspect channel.");
    for (const ChannelSuspect& suspect : rigidity.suspects) lines.push_back("Suspect: " + describe(suspect));
    for (const std::string& note : rigidity.notes) lines.push_back("Note: " + note);
    for (const std::string& warning : recording.warnings) lines.push_back("Warning: " + warning);
    return lines;
}

}  // namespace

double RigidityAnswer::findLargest() const {
    double largest = 0;
    for (const RigidityCheck& check : rigidity.checks) largest = std::max(largest, check.max_percent);
    return largest;
}

RigidityAnswer runRigidity(const RigidityRequest& request, Watcher& watcher) {
    RigidityAnswer answer;
    answer.record = beginRecord("rigidity");
    answer.model = readDeviceModel(request.model, request.geometry);
    addInput(answer.record, "model", request.model);
    answer.record.addInput("bracket modes", answer.model.bracket_path);
    answer.record.addInput("columns", request.columns);
    answer.record.addInput("geometry", request.geometry);
    addInput(answer.record, "recording", request.recording);
    watcher.onInputs(listFiles(answer.record));
    if (const auto map = readDeviceMap(request.columns, answer.model)) answer.record.addColumns(*map);
    watcher.onStep("reading " + request.recording.file, 0, 1);
    answer.recording = readDeviceRecordings({request.recording}, request.columns, answer.model).front();
    watcher.onStep("checks", 0.45, 1);  // as a sweep of 50 000 samples takes
    answer.rigidity = checkRigidity(answer.recording, answer.model);
    answer.quality = judgeQuality(answer.recording, &answer.model, answer.recording.findings);
    return answer;
}

nlohmann::json toJson(const RigidityAnswer& answer) {
    nlohmann::json result = makeJson(answer.rigidity, answer.quality, answer.recording);
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const RigidityAnswer& answer, TextStyle style) {
    std::string text = makeTable(answer.rigidity).format(style);
    for (const std::string& line : makeSentences(answer.rigidity, answer.quality, answer.recording))
        text += (line.rfind("Suspect", 0) == 0 ? paint(line, Colour::yellow, style) : line) + "\n";
    return text;
}

void writeReport(const RigidityAnswer& answer, const std::string& file, OutputFiles& outputs) {
    writeRigidityReport(answer.rigidity, makeTable(answer.rigidity),
                        makeSentences(answer.rigidity, answer.quality, answer.recording), answer.recording,
                        answer.model, file, outputs);
}

}  // namespace wems::identify::commands
