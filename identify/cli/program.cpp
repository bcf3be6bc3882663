// The commands on recordings.
#include "identify/cli/program.hpp"

#include "identify/cli/command.hpp"
#include "models/command_line/completion.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"

namespace wems::identify::cli {

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
    addSingleAxisCommand(app, exit_status);
    addBeamTipCommand(app, exit_status);
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
