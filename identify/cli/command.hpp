/// @file
/// What the commands of the executable share. Each command lives in its own file and registers itself on the parser.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/commands/format.hpp"
#include "identify/commands/long_recordings.hpp"
#include "identify/commands/recordings.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/progress.hpp"
#include "models/common/text_table.hpp"
#include "models/result/result_record.hpp"

namespace wems::identify::cli {

using namespace commands;

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
/// --memory
void addMemoryOption(CLI::App& command, MemoryOption& option);

/// --fail-on, the verdicts upon which the exit status is 1.
void addFailOption(CLI::App& command, std::vector<std::string>& verdicts, const std::vector<std::string>& accepted);
/// Says so and sets the exit status if `verdict` is one of them.
void failOn(const std::vector<std::string>& verdicts, const std::string& verdict, int& exit_status);

/// One function for each command: adds the subcommand, its options and an example, and sets its callback. The callback
/// throws InputError on bad input and sets `exit_status` to 1 if the question was answered but a requested limit
/// failed.
void addRigidityCommand(CLI::App& app, int& exit_status);
void addFitCommand(CLI::App& app, int& exit_status);
void addEquationsCommand(CLI::App& app, int& exit_status);
void addJoinCommand(CLI::App& app, int& exit_status);
void addSurfaceCommand(CLI::App& app, int& exit_status);
void addSpectraCommand(CLI::App& app, int& exit_status);
void addCompareCommand(CLI::App& app, int& exit_status);
void addDiagnoseCommand(CLI::App& app, int& exit_status);
void addPlanCommand(CLI::App& app, int& exit_status);
void addInspectCommand(CLI::App& app, int& exit_status);
void addConvertCommand(CLI::App& app, int& exit_status);
void addMergeCommand(CLI::App& app, int& exit_status);
void addSetCommand(CLI::App& app, int& exit_status);
void addSchemaCommand(CLI::App& app, int& exit_status);

/// How text on standard output is to look.
TextStyle outputStyle();

/// Writes `result` as JSON if --json was given: to standard output for `-`, else as one of the command's files.
void writeJson(const nlohmann::json& result, const CommonOptions& options, OutputFiles& outputs);

/// Shows a command's steps on the terminal, and keeps the command from writing what it reads.
class TerminalWatcher : public Watcher {
public:
    /// @param output of -o; empty without
    TerminalWatcher(std::string output, const CommonOptions& options, OutputFiles& outputs)
        : output_(std::move(output)), options_(options), outputs_(outputs), progress_(std::in_place, !options.quiet) {}
    void onInputs(const std::vector<std::string>& files) override;
    void onStep(const ProgressEvent& step) override { progress_->step(step); }
    void onProgress(double done, const std::string& what) override { progress_->show(done, what); }
    /// The line goes: text follows.
    void close() { progress_.reset(); }

private:
    std::string output_;
    const CommonOptions& options_;
    OutputFiles& outputs_;
    std::optional<Progress> progress_;
};

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
