// The commands on recordings.
#include "identify/cli/program.hpp"

#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "identify/cli/command.hpp"
#include "models/command_line/standard_streams.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"

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

void addMemoryOption(CLI::App& command, MemoryOption& option) {
    command
        .add_option("--memory", option.megabytes,
                    "MB that recordings may take; longer ones but MATLAB files before 7.3 are worked through in blocks "
                    "(default 2000)")
        ->check(isPositive());
}

TextStyle outputStyle() {
    return styleOf(STDOUT_FILENO);
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

void addFailOption(CLI::App& command, std::vector<std::string>& verdicts, const std::vector<std::string>& accepted) {
    command.add_option("--fail-on", verdicts, "exit status 1 with this verdict; several with commas between")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::IsMember(accepted));
}

void failOn(const std::vector<std::string>& verdicts, const std::string& verdict, int& exit_status) {
    if (std::find(verdicts.begin(), verdicts.end(), verdict) == verdicts.end()) return;
    std::cerr << "identify: the verdict is " << verdict << "\n";
    exit_status = 1;
}

void TerminalWatcher::onInputs(const std::vector<std::string>& files) {
    protectInputs(files, output_, options_, outputs_);
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

int runIdentify(int argc, char** argv) {
    CLI::App app{"Identify mounts with elastomers and stops from recordings."};
    app.name(programName(argv[0]));
    app.require_subcommand(1);
    app.set_help_all_flag("--help-all", "help of every command");
    app.set_version_flag("--version", "wems identify " WEMS_VERSION);
    app.footer(
        "A first walk: what is in a recording, what the mount is, where the model is wrong and why:\n"
        "  identify inspect run.csv\n"
        "  identify fit run.csv --model mount.toml -o fitted.toml\n"
        "  identify diagnose run.csv --model mount.toml --validate other.csv -o extended.toml\n"
        "Each command has a help with an example of its own: identify fit --help\n\n"
        "Exit status: 0 done, 1 answered but a requested limit failed, 2 bad input or usage.");
    addCompletionOption(app);
    std::optional<tbb::global_control> limit;
    app.add_option_function<std::size_t>(
           "--threads",
           [&limit](const std::size_t& count) { limit.emplace(tbb::global_control::max_allowed_parallelism, count); },
           "how many threads work (default: one for each core)")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1024}));
    app.fallthrough();  // also behind the command
    int exit_status = 0;
    // In the order of a test's evaluation.
    addConvertCommand(app, exit_status);
    addMergeCommand(app, exit_status);
    addInspectCommand(app, exit_status);
    addSpectraCommand(app, exit_status);
    addRigidityCommand(app, exit_status);
    addFitCommand(app, exit_status);
    addEquationsCommand(app, exit_status);
    addJoinCommand(app, exit_status);
    addDiagnoseCommand(app, exit_status);
    addPlanCommand(app, exit_status);
    addCompareCommand(app, exit_status);
    addSurfaceCommand(app, exit_status);
    addSetCommand(app, exit_status);
    addSchemaCommand(app, exit_status);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // help or version
        throw InputError({}, describeUsageError(app, error));
    }
    return exit_status;
}

}  // namespace wems::identify::cli
