#include "plugin/linear_command.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "models/atomic_file.hpp"
#include "models/error.hpp"
#include "models/terminal.hpp"
#include "plugin/linear_analysis.hpp"

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

bool writeJsonText(const nlohmann::json& result, const std::string& file) {
    if (file.empty()) return false;
    // Names of files need not be UTF-8.
    const std::string text = result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (file != "-") {
        AtomicFile::write(file, text);
        return false;
    }
    std::cout << text;
    return true;
}

void runLinearAnalysis(const SimulateOptions& options) {
    LinearQuestion question;
    question.direction = {options.force, options.base_acceleration};
    if (!options.band.empty()) question.band = parseBand(options.band, "--frf");
    if (options.kind != nullptr) question.spectrum = readLevelledSpectrum(options);
    const LinearAnalysis analysis = analyseLinearly(readMountModel(options.model_file), question);
    if (!options.output_file.empty()) AtomicFile::write(options.output_file, formatAnalysisCsv(analysis));
    if (!options.report_file.empty()) writeAnalysisReport(analysis, options.report_file);
    if (writeJsonText(makeAnalysisJson(analysis), options.json_file)) return;
    if (!options.quiet) std::cout << formatAnalysis(analysis, styleOf(STDOUT_FILENO));
}

}  // namespace wems::plugin
