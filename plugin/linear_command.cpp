#include "plugin/linear_command.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "models/command_line/standard_streams.hpp"
#include "models/error.hpp"
#include "models/terminal.hpp"
#include "plugin/linear_analysis.hpp"
#include "plugin/run_settings.hpp"

namespace wems::plugin {

std::pair<double, double> parseBand(const std::string& text, const std::string& option) {
    const auto colon = text.find(':');
    char *from_end = nullptr, *to_end = nullptr;
    const std::string left = text.substr(0, colon), right = colon == std::string::npos ? "" : text.substr(colon + 1);
    const double from = std::strtod(left.c_str(), &from_end), to = std::strtod(right.c_str(), &to_end);
    const bool numbers = !left.empty() && !right.empty() && *from_end == '\0' && *to_end == '\0';
    if (!numbers || !(from > 0 && std::isfinite(to) && to > from))
        throw InputError({"", 0, option}, "`" + text + "` is not understood",
                         "two ascending frequencies in Hz, such as 5:50");
    return {from, to};
}

OutputFiles beginOutputs(const SimulateOptions& options, const MountModel& model) {
    checkOutputs({options.output_file, options.json_file == "-" ? "" : options.json_file, options.report_file},
                 {model.bracket_path});
    OutputFiles outputs;
    outputs.protect({options.model_file, model.bracket_path});
    return outputs;
}

void finishOutputs(const SimulateOptions& options, const nlohmann::json& result, const std::string& text,
                   OutputFiles& outputs) {
    const bool data_on_output = options.json_file == "-";
    // Names of files need not be UTF-8.
    const std::string json = result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (data_on_output) {
        std::cout << json;
    } else {
        if (!options.json_file.empty()) outputs.add(options.json_file, json);
        if (!options.quiet) std::cout << text;
    }
    flushStandardOutput();
    outputs.commit();
}

LinearQuestion makeQuestion(const SimulateOptions& options) {
    LinearQuestion question;
    question.direction = {options.force, options.base_acceleration};
    if (!options.band.empty()) question.band = parseBand(options.band, "--frf");
    if (options.kind != nullptr) question.spectrum = readLevelledSpectrum(options);
    return question;
}

void runLinearAnalysis(const SimulateOptions& options) {
    const LinearQuestion question = makeQuestion(options);
    const MountModel model = readMountModel(options.model_file);
    OutputFiles outputs = beginOutputs(options, model);
    const LinearAnalysis analysis = analyseLinearly(model, question);
    if (!options.output_file.empty()) outputs.add(options.output_file, formatAnalysisCsv(analysis));
    if (!options.report_file.empty())
        writeAnalysisReport(analysis, readDrawing(options.model_file), options.report_file, outputs);
    nlohmann::json result = makeAnalysisJson(analysis);
    addRecord(result, makeRecord(options, "modes", model));
    finishOutputs(options, result, formatAnalysis(analysis, styleOf(STDOUT_FILENO)), outputs);
}

}  // namespace wems::plugin
