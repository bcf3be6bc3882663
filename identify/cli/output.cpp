#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "identify/cli/command.hpp"
#include "models/command_line/standard_streams.hpp"
#include "models/command_line/usage.hpp"

namespace wems::identify::cli {

void addResultOptions(CLI::App& command, CommonOptions& options) {
    addOutputFile(command, "--json", options.json_file, "write the result as JSON to FILE (- for standard output)",
                  true);
    addOutputFile(command, "--report", options.report_file, "write a self-contained HTML page with pictures to FILE");
    addQuietOption(command, options.quiet);
}

void addCommonOptions(CLI::App& command, CommonOptions& options) {
    addResultOptions(command, options);
    addInputFile(command, "--columns", options.column_map, "TOML that maps your column names to channel names");
}

void addQuietOption(CLI::App& command, bool& quiet) {
    command.add_flag("-q,--quiet", quiet, "no progress and no text on standard output");
}

void addGeometryOption(CLI::App& command, CommonOptions& options) {
    addInputFile(command, "--geometry", options.geometry,
                 "TOML with [[marker]] and [[accelerometer]]: sensors that are not at the connections");
}

TextStyle outputStyle() {
    return styleOf(STDOUT_FILENO);
}

std::string formatNumber(double value, int digits) {
    if (!std::isfinite(value)) return "-";
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    // 100280 rather than 1.0028e+05 beside 99690: zeros are easier to compare than powers of ten.
    constexpr double largest_written_out = 1e7;
    if (std::strchr(buffer, 'e') != nullptr && std::abs(value) >= 1 && std::abs(value) < largest_written_out)
        std::snprintf(buffer, sizeof buffer, "%.0f", std::strtod(buffer, nullptr));
    return buffer;
}

std::string formatPercent(double share) {
    return std::isfinite(share) ? formatNumber(100 * share, 3) + " %" : std::string("-");
}

nlohmann::json numberOrNull(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

void writeJson(const nlohmann::json& result, const CommonOptions& options, OutputFiles& outputs) {
    if (options.json_file.empty()) return;
    // Names of files need not be UTF-8.
    const std::string text = result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (options.json_file == "-") {
        std::cout << text;
    } else {
        outputs.add(options.json_file, text);
    }
}

void protectInputs(const std::vector<std::string>& inputs, const std::string& output, const CommonOptions& options,
                   OutputFiles& outputs) {
    checkOutputs({output, options.json_file == "-" ? "" : options.json_file, options.report_file}, inputs);
    outputs.protect(inputs);
}

void finishOutput(OutputFiles& outputs) {
    flushStandardOutput();
    outputs.commit();
}

}  // namespace wems::identify::cli
