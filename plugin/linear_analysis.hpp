/// @file
/// What `simulate --modes` and `--frf` find in a model without a run: rest position, modes, transfer functions, random
/// response, all of the model linearised about its rest position.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"
#include "models/damped_modes.hpp"
#include "models/device_drawing.hpp"
#include "models/linear_response.hpp"
#include "models/mount_model.hpp"
#include "models/static_equilibrium.hpp"
#include "plugin/simulate_options.hpp"

namespace wems::plugin {

/// Responses of every output (linear_response.hpp) to one unit of the input.
struct TransferFunctions {
    std::string input, input_unit;  ///< `base acceleration z`, `m/s^2`
    std::vector<double> frequency;  ///< Hz
    Eigen::MatrixXcd response;      ///< outputs x frequencies
};

struct LinearAnalysis {
    MountModel model;
    LinearSystem system;
    StaticSag sag;
    std::vector<DampedMode> modes;
    std::optional<TransferFunctions> transfer;
    std::optional<RandomResponse> random;
    std::string random_input;  ///< `base acceleration z, 1.2 g RMS from 20 to 2000 Hz`
};

/// What is asked for beside modes and rest position.
struct LinearQuestion {
    HarmonicInput direction;                        ///< of size 1 for transfer functions; times the spectrum
    std::optional<std::pair<double, double>> band;  ///< Hz, of transfer functions
    std::optional<PowerSpectrum> spectrum;
};

/// @throws InputError if the model cannot be simulated, has no stable rest position, or nothing would move
LinearAnalysis analyseLinearly(const MountModel& model, const LinearQuestion& question);

/// `1.z relative displacement` and the like: name, unit of the response itself.
struct OutputName {
    std::string name, unit;
};
std::vector<OutputName> nameOutputs(const MountModel& model);

/// Connection and axis that move most in a mode, relative to each other; `bracket` where the parts move together.
std::string describeShape(const LinearAnalysis& analysis, const DampedMode& mode);

std::string formatAnalysis(const LinearAnalysis& analysis, TextStyle style);
nlohmann::json makeAnalysisJson(const LinearAnalysis& analysis);
/// Columns `frequency [Hz]`, then of each output its real and imaginary part, or its density.
std::string formatAnalysisCsv(const LinearAnalysis& analysis);
/// Modes in motion, transfer functions, densities. @throws InputError: cannot be written.
void writeAnalysisReport(const LinearAnalysis& analysis, const std::vector<DrawnShape>& drawing,
                         const std::string& file, OutputFiles& outputs);

// `simulate --modes`, `--frf`: what the linear model says, without a run.

/// What the options ask of the linear model; reads a spectrum. @throws InputError
LinearQuestion makeQuestion(const SimulateOptions& options);

/// Reads model and spectrum, prints and writes what was asked for. @throws InputError
void runLinearAnalysis(const SimulateOptions& options);

/// `5:50` as two frequencies, ascending. @throws InputError naming `option`
std::pair<double, double> parseBand(const std::string& text, const std::string& option);

/// The files of a command without a run, checked against the model's before anything is computed.
/// @throws InputError if one of them is read
OutputFiles beginOutputs(const SimulateOptions& options, const MountModel& model);

/// Writes JSON, or `text` to standard output unless --quiet or --json - took it; then all files appear, or none.
void finishOutputs(const SimulateOptions& options, const nlohmann::json& result, const std::string& text,
                   OutputFiles& outputs);

}  // namespace wems::plugin
