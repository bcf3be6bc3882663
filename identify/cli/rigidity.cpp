// identify rigidity: does each part of a recording move as a rigid body?
#include "identify/motion/rigidity.hpp"

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/command.hpp"
#include "identify/cli/quality_output.hpp"
#include "identify/cli/recordings.hpp"
#include "identify/cli/rigidity_report.hpp"
#include "models/command_line/usage.hpp"
#include "models/mount_model.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

struct RigidityOptions {
    std::string recording, model;
    double limit = 0;
    CommonOptions common;
};

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

void runRigidity(const RigidityOptions& options, bool limited, int& exit_status) {
    OutputFiles outputs;
    const MountModel model = readDeviceModel(options.model, options.common.geometry);
    protectInputs({model.bracket_path}, "", options.common, outputs);
    std::optional<Progress> progress(std::in_place, !options.common.quiet);
    progress->step("reading " + options.recording);
    const Recording recording = readDeviceRecordings({options.recording}, options.common.column_map, model).front();
    const bool report = !options.common.report_file.empty();
    progress->step("checks", report ? 0.25 : 0.45, report ? 0.6 : 1.0);  // as a sweep of 50 000 samples takes
    const Rigidity rigidity = checkRigidity(recording, model);
    const QualityVerdict quality = judgeQuality(recording, &model, recording.findings);
    const Table table = makeTable(rigidity);
    const std::vector<std::string> sentences = makeSentences(rigidity, quality, recording);
    if (report) {
        progress->step("report", 0.6);
        writeRigidityReport(rigidity, table, sentences, recording, model, readDrawing(options.model),
                            options.common.report_file, outputs);
    }
    progress.reset();
    if (options.common.printsText()) {
        std::cout << table.format(outputStyle());
        for (const std::string& line : sentences)
            std::cout << (line.rfind("Suspect", 0) == 0 ? paint(line, Colour::yellow, outputStyle()) : line) << "\n";
    }
    writeJson(makeJson(rigidity, quality, recording), options.common, outputs);
    finishOutput(outputs);
    if (!limited) return;
    for (const RigidityCheck& check : rigidity.checks) {
        if (check.max_percent > options.limit) exit_status = 1;
    }
}

}  // namespace

void addRigidityCommand(CLI::App& app, int& exit_status) {
    CLI::App* command = app.add_subcommand("rigidity", "Check that each part of a recording moves as a rigid body");
    const auto options = std::make_shared<RigidityOptions>();
    addInputFile(*command, "recording", options->recording, std::string("recording (") + kReadableFormats + ")")
        ->required();
    addInputFile(*command, "--model", options->model, "mount model (TOML)")->required();
    CLI::Option* limit =
        command->add_option("--limit", options->limit, "exit status 1 if a check exceeds this, in percent");
    limit->check(isNonNegative());
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer("Example:\n  identify rigidity run.csv --model smallsat.toml --limit 0.5 --json rigidity.json");
    command->callback([options, limit, &exit_status] { runRigidity(*options, limit->count() > 0, exit_status); });
}

}  // namespace wems::identify::cli
