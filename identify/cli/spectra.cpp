// identify spectra: frequency responses, densities, orders, shock response and margins of recordings.
#include <iostream>
#include <memory>
#include <optional>

#include "identify/cli/recordings.hpp"
#include "identify/cli/spectra_output.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"
#include "models/progress.hpp"
#include "models/recording/recording_reader.hpp"

namespace wems::identify::cli {
namespace {

struct SpectraOptions {
    CommonOptions common;
    std::vector<std::string> recordings;
    std::string model, reference, band;
    double resolution = 0, quality = 10;
};

std::pair<double, double> parseBand(const std::string& text) {
    double from = 0, to = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%lf:%lf%c", &from, &to, &rest) != 2 || !(from > 0 && to > from))
        throw InputError({"", 0, "--band"}, "`" + text + "` is not understood",
                         "two ascending frequencies in Hz, such as 5:50");
    return {from, to};
}

std::vector<RunSpectra> calcAll(const SpectraOptions& options, OutputFiles& outputs) {
    SpectraSettings settings;
    if (options.resolution > 0) settings.resolution = options.resolution;
    if (!options.band.empty()) settings.band = parseBand(options.band);
    settings.reference = options.reference;
    settings.quality = options.quality;
    std::optional<MountModel> model;
    if (!options.model.empty()) model = readDeviceModel(options.model, options.common.geometry);
    if (model) protectInputs({model->bracket_path}, "", options.common, outputs);
    const std::optional<ColumnMap> map =
        model ? readDeviceMap(options.common.column_map, *model) : readOptionalMap(options.common.column_map);
    Progress progress(!options.common.quiet);
    std::vector<RunSpectra> runs;
    for (const auto& file : options.recordings) {
        progress.step("spectra of " + file);
        const Recording recording = readRecording(file, map ? &*map : nullptr);
        for (const auto& warning : recording.warnings) std::cerr << "identify: " << file << ": " << warning << "\n";
        runs.push_back(calcRunSpectra(recording, model ? &*model : nullptr, settings));
    }
    return runs;
}

}  // namespace

void addSpectraCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand(
        "spectra",
        "Transmissibility, frequency response, power and shock spectra, orders, strokes and clearances left");
    auto options = std::make_shared<SpectraOptions>();
    addInputFile(*command, "recordings", options->recordings,
                 std::string("recordings (") + kReadableFormats + "); several are overlaid in the report")
        ->required();
    addInputFile(*command, "--model", options->model, "mount model: forces of the connections and clearances left");
    command->add_option("--reference", options->reference,
                        "channel that drives (absent: the strongest of load, base, fixed part)");
    command
        ->add_option("--resolution", options->resolution,
                     "Hz from one line to the next (absent: 20 segments, 8 of a sweep)")
        ->check(isPositive());
    command->add_option("--band", options->band, "f0:f1 in Hz, where peaks are looked for (absent: what is excited)");
    command->add_option("--q", options->quality, "quality factor Q of the shock response spectrum (default 10)")
        ->check(CLI::Validator(
            [](std::string& text) {
                return std::atof(text.c_str()) > 0.5 ? std::string() : "'" + text + "' is not above 0.5";
            },
            "ABOVE 0.5"));
    addCommonOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer(
        "Example, three levels of one test overlaid, with what is left of each clearance:\n"
        "  identify spectra low.csv middle.csv high.csv --model mount.toml --report spectra.html");
    command->callback([options] {
        OutputFiles outputs;
        const std::vector<RunSpectra> runs = calcAll(*options, outputs);
        if (options->common.printsText()) std::cout << formatSpectra(runs, outputStyle());
        writeJson(makeSpectraJson(runs), options->common, outputs);
        if (!options->common.report_file.empty()) writeSpectraReport(runs, options->common.report_file, outputs);
        finishOutput(outputs);
    });
}

}  // namespace wems::identify::cli
