// The executable `identify`: commands on recordings.
#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "identify/cli/command.hpp"
#include "models/command_line/completion.hpp"
#include "models/command_line/standard_streams.hpp"
#include "models/command_line/usage.hpp"
#include "models/error.hpp"

namespace {

/// Matrices of some megabytes come and go by the thousand; glibc would map and unmap, and the kernel zero, each one.
void keepFreedMemory() {
#ifdef __GLIBC__
    constexpr int largest = 32 << 20, kept = 1 << 30;
    mallopt(M_MMAP_THRESHOLD, largest);
    mallopt(M_TRIM_THRESHOLD, kept);
#endif
}

int run(int argc, char** argv) {
    keepFreedMemory();
    CLI::App app{"Identify mounts with elastomers and stops from recordings."};
    app.name(wems::programName(argv[0]));
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
    wems::addCompletionOption(app);
    int exit_status = 0;
    // In the order of a test's evaluation.
    wems::identify::cli::addConvertCommand(app, exit_status);
    wems::identify::cli::addMergeCommand(app, exit_status);
    wems::identify::cli::addInspectCommand(app, exit_status);
    wems::identify::cli::addSpectraCommand(app, exit_status);
    wems::identify::cli::addRigidityCommand(app, exit_status);
    wems::identify::cli::addFitCommand(app, exit_status);
    wems::identify::cli::addDiagnoseCommand(app, exit_status);
    wems::identify::cli::addPlanCommand(app, exit_status);
    wems::identify::cli::addCompareCommand(app, exit_status);
    wems::identify::cli::addSurfaceCommand(app, exit_status);
    wems::identify::cli::addSingleAxisCommand(app, exit_status);
    wems::identify::cli::addBeamTipCommand(app, exit_status);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // help or version
        throw wems::InputError({}, wems::describeUsageError(app, error));
    }
    return exit_status;
}

}  // namespace

int main(int argc, char** argv) {
    return wems::runProgram("identify", run, argc, argv);
}
