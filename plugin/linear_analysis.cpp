#include "plugin/linear_analysis.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "models/command_line/standard_streams.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_table.hpp"
#include "plugin/run_settings.hpp"

namespace wems::plugin {

namespace {

std::string describeInput(const HarmonicInput& direction) {
    const bool load = !direction.load.isZero();
    std::string text = load ? "force" : "base acceleration";
    for (int i = 0; i < 3; ++i)
        if (const double size = load ? direction.load[i] : direction.base[i]; size != 0)
            text += std::string(" ") + "xyz"[i] + (size == 1 ? "" : " x " + formatNumber(size));
    return text;
}

/// Evenly in log f, and denser about each resonance: nine places within three half widths.
std::vector<double> makeGrid(double from, double to, const std::vector<DampedMode>& modes) {
    constexpr int even = 400;
    std::vector<double> grid;
    for (int k = 0; k <= even; ++k) grid.push_back(from * std::pow(to / from, double(k) / even));
    for (const DampedMode& mode : modes)
        for (int k = -6; k <= 6; ++k) {
            const double f = mode.damped_frequency * (1 + 0.5 * k * mode.damping_ratio);
            if (f > from && f < to) grid.push_back(f);
        }
    grid.back() = std::min(grid.back(), to);
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
    return grid;
}

}  // namespace

LinearAnalysis analyseLinearly(const MountModel& model, const LinearQuestion& question) {
    validate(model);
    LinearAnalysis analysis;
    analysis.model = model;
    const LinearDynamics dynamics(model);
    analysis.system = dynamics.system();
    analysis.sag = findStaticSag(model);
    analysis.modes = findDampedModes(analysis.system);
    const HarmonicInput& input = question.direction;
    if (!input.load.isZero() && (analysis.system.load * input.load).isZero(0))
        throw InputError({"", 0, "--force"}, "moves nothing in this model",
                         "--base-acceleration, a model with [bracket], or [load] part = \"mobile\"");
    if (question.band) {
        TransferFunctions transfer;
        transfer.input = describeInput(input);
        transfer.input_unit = input.load.isZero() ? "m/s^2" : "N";
        transfer.frequency = makeGrid(question.band->first, question.band->second, analysis.modes);
        for (std::size_t k = 0; k < transfer.frequency.size(); ++k) {
            const Eigen::VectorXcd outputs = listOutputs(dynamics.calcResponse(transfer.frequency[k], input));
            if (k == 0) transfer.response.resize(outputs.size(), transfer.frequency.size());
            transfer.response.col(k) = outputs;
        }
        analysis.transfer = std::move(transfer);
    }
    if (question.spectrum) {
        const PowerSpectrum& spectrum = *question.spectrum;
        constexpr double g = 9.80665;
        const bool acceleration = spectrum.quantity() == Quantity::acceleration;
        analysis.random = calcRandomResponse(dynamics, input, spectrum,
                                             makeGrid(spectrum.lowest(), spectrum.highest(), analysis.modes));
        const double size = (input.load + input.base).norm();
        analysis.random_input = describeInput(input) + ", " +
                                formatNumber(size * spectrum.calcRms() / (acceleration ? g : 1), 4) +
                                (acceleration ? " g" : " N") + " RMS from " + formatNumber(spectrum.lowest()) + " to " +
                                formatNumber(spectrum.highest()) + " Hz";
    }
    return analysis;
}

std::vector<OutputName> nameOutputs(const MountModel& model) {
    std::vector<OutputName> names;
    for (const Connection& connection : model.connections) {
        for (const char axis : {'x', 'y', 'z'}) names.push_back({"relative." + connection.name + "." + axis, "m"});
        for (const char axis : {'x', 'y', 'z'}) names.push_back({"force." + connection.name + "." + axis, "N"});
        for (const char axis : {'x', 'y', 'z'}) names.push_back({"mobile." + connection.name + ".a" + axis, "m/s^2"});
        for (const char axis : {'x', 'y', 'z'}) names.push_back({"fixed." + connection.name + ".a" + axis, "m/s^2"});
    }
    return names;
}

std::string describeShape(const LinearAnalysis& analysis, const DampedMode& mode) {
    double largest = 0, relative = 0;
    std::string name;
    for (std::size_t i = 0; i < analysis.system.ends.size(); ++i) {
        const Eigen::Vector3d mobile = (analysis.system.mobile_ends[i] * mode.shape).cwiseAbs();
        const Eigen::Vector3d fixed = (analysis.system.fixed_ends[i] * mode.shape).cwiseAbs();
        const Eigen::Vector3d between = (analysis.system.ends[i] * mode.shape).cwiseAbs();
        largest = std::max({largest, mobile.maxCoeff(), fixed.maxCoeff()});
        for (int k = 0; k < 3; ++k)
            if (between[k] > (1 + 1e-9) * relative) {
                relative = between[k];
                name = analysis.model.connections[i].name + "." + "xyz"[k];
            }
    }
    constexpr double together = 0.05;  // of the largest motion: the mount hardly deforms
    return relative > together * largest ? name : "bracket";
}

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
