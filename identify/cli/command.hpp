/// @file
/// What the commands of the executable share. Each command lives in its own file and registers itself on the parser.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/atomic_file.hpp"
#include "models/text_table.hpp"

namespace wems::identify::cli {

/// Options that every command has.
struct CommonOptions {
    std::string json_file;    ///< --json FILE; `-` writes to standard output in place of the table
    std::string report_file;  ///< --report FILE.html
    std::string column_map;   ///< --columns map.toml
    std::string geometry;     ///< --geometry layout.toml
    bool quiet = false;       ///< --quiet

    /// Whether the result is wanted as text: not quiet, and standard output not taken by --json -.
    bool printsText() const { return !quiet && json_file != "-"; }
};
void addCommonOptions(CLI::App& command, CommonOptions& options);
/// Those without --columns.
void addResultOptions(CLI::App& command, CommonOptions& options);
/// --quiet, which addCommonOptions() adds too
void addQuietOption(CLI::App& command, bool& quiet);
/// --geometry, of commands that know a model
void addGeometryOption(CLI::App& command, CommonOptions& options);

/// One function for each command: adds the subcommand, its options and an example, and sets its callback. The callback
/// throws InputError on bad input and sets `exit_status` to 1 if the question was answered but a requested limit
/// failed.
void addRigidityCommand(CLI::App& app, int& exit_status);
void addFitCommand(CLI::App& app, int& exit_status);
void addSurfaceCommand(CLI::App& app, int& exit_status);
void addSpectraCommand(CLI::App& app, int& exit_status);
void addCompareCommand(CLI::App& app, int& exit_status);
void addDiagnoseCommand(CLI::App& app, int& exit_status);
void addPlanCommand(CLI::App& app, int& exit_status);
void addInspectCommand(CLI::App& app, int& exit_status);
void addConvertCommand(CLI::App& app, int& exit_status);
void addMergeCommand(CLI::App& app, int& exit_status);
void addSetCommand(CLI::App& app, int& exit_status);
void addSingleAxisCommand(CLI::App& app, int& exit_status);
void addBeamTipCommand(CLI::App& app, int& exit_status);

using wems::Table;

/// How text on standard output is to look.
TextStyle outputStyle();

/// `digits` significant digits, no trailing noise, powers of ten only from 1e7 on and below 1e-4; `-` for a value that
/// is not finite.
std::string formatNumber(double value, int digits = 5);
/// Of a share: `1.23 %`
std::string formatPercent(double share);
/// JSON has no infinity and no NaN: null.
nlohmann::json numberOrNull(double value);

/// Writes `result` as JSON if --json was given: to standard output for `-`, else as one of the command's files.
void writeJson(const nlohmann::json& result, const CommonOptions& options, OutputFiles& outputs);

/// Files that a command reads beside those of its command line, such as the runs of a test file or the bracket modes of
/// a model: none of them may be written.
/// @param output of -o; empty without
/// @throws InputError if one would be
void protectInputs(const std::vector<std::string>& inputs, const std::string& output, const CommonOptions& options,
                   OutputFiles& outputs);

/// The end of a command: what was printed is handed over, then its files appear, all of them or none.
/// @throws InputError if standard output or the disk does not take them
void finishOutput(OutputFiles& outputs);

}  // namespace wems::identify::cli
