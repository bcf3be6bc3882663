// Does each part of a recording move as a rigid body?
#include "identify/commands/rigidity.hpp"

#include <algorithm>
#include <cmath>

#include "identify/commands/device_scene.hpp"
#include "identify/commands/format.hpp"
#include "identify/commands/inspect_output.hpp"
#include "identify/commands/recordings.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/report/html_report.hpp"
#include "models/sensor_reading.hpp"

namespace wems::identify::commands {
namespace {

/// The check over time and swept frequency, some 1000 samples that keep its shape.
nlohmann::json makeHistory(const Rigidity& rigidity, const RigidityCheck& check) {
    const std::vector<double> percent(check.percent.begin(), check.percent.end());
    auto time = nlohmann::json::array(), hertz = time, values = time;
    for (const std::size_t k : decimateByShape(percent, 250)) {
        time.push_back(rigidity.time[k]);
        hertz.push_back(numberOrNull(rigidity.swept.hertz(k)));
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

constexpr Eigen::Index kStretches = 200;

/// The noise of ten checks over all samples would be a black band.
Series takeLargest(const RigidityCheck& check, const std::vector<double>& x) {
    Series series{check.name, {}, {}};
    const Eigen::Index count = std::min<Eigen::Index>(check.percent.size(), x.size()),
                       stretches = std::min(count, kStretches);
    for (Eigen::Index s = 0; s < stretches; ++s) {
        const Eigen::Index from = s * count / stretches, to = (s + 1) * count / stretches;
        series.x.push_back(x[(from + to) / 2]);
        series.y.push_back(check.percent.segment(from, to - from).cwiseAbs().maxCoeff());
    }
    return series;
}

void addMotionIfKnown(HtmlReport& report, const Recording& recording, const MountModel& model) {
    try {
        addMotion(report, makeDeviceScene({recording}, model));
    } catch (const InputError& error) {
        report.addText(std::string("The device cannot be shown in motion: ") + error.what());
    }
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
    const DeviceInputs inputs =
        readInputs(request.model, request.columns, request.geometry, {request.recording}, answer.record, watcher);
    if (!inputs.model) throw InputError({}, "there is no model", "the device's model");
    answer.model = *inputs.model;
    watcher.onStep({"reading " + request.recording.file});
    answer.recording = correctChannels(readDeviceRecordings({request.recording}, request.columns, answer.model).front(),
                                       answer.model.sensors);
    watcher.onStep({"checks", 0.45, 1});  // as a sweep of 50 000 samples takes
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
    const Rigidity& rigidity = answer.rigidity;
    const Table table = makeTable(rigidity);
    HtmlReport report("Rigidity: " + answer.recording.file);
    const auto worst =
        std::max_element(rigidity.checks.begin(), rigidity.checks.end(),
                         [](const RigidityCheck& a, const RigidityCheck& b) { return a.max_percent < b.max_percent; });
    if (worst != rigidity.checks.end())
        report.addLead("The largest error of a rigid body's geometry is " + formatNumber(worst->max_percent, 3) +
                       " %, that of " + worst->name +
                       (std::isfinite(worst->at_frequency) ? " at " + formatNumber(worst->at_frequency, 4) + " Hz"
                                                           : " at " + formatNumber(worst->at_time, 4) + " s") +
                       ".");
    report.addTable(table.header(), table.rows());
    for (const std::string& sentence : makeSentences(rigidity, answer.quality, answer.recording))
        report.addText(sentence);
    report.addText("Drawn is the largest error of each check, either way, in each of up to " +
                   std::to_string(kStretches) + " stretches of the run.");
    const auto& hertz = rigidity.swept.hertz;
    const std::vector<double> frequencies(hertz.data(), hertz.data() + hertz.size());
    for (const bool fixed : {false, true}) {
        const std::string part = fixed ? "fixed part" : "mobile part";
        Plot time{"Error over time, " + part, "time [s]", "largest error [%]", {}},
            frequency{"Error over swept frequency, " + part, "swept frequency [Hz]", "largest error [%]", {}};
        for (const RigidityCheck& check : rigidity.checks) {
            if ((check.name.rfind("fixed ", 0) == 0) != fixed) continue;
            time.series.push_back(takeLargest(check, rigidity.time));
            if (rigidity.swept.is_sine) frequency.series.push_back(takeLargest(check, frequencies));
        }
        if (!time.series.empty()) report.addPlot(time);
        if (!frequency.series.empty()) report.addPlot(frequency);
    }
    addMotionIfKnown(report, answer.recording, answer.model);
    report.write(file, outputs);
}

}  // namespace wems::identify::commands
