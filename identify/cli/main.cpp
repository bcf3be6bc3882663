// The executable `identify`: commands on recordings.
#include <cstdlib>
#include <exception>
#include <iostream>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "identify/cli/command.hpp"
#include "models/command_line/completion.hpp"
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

}  // namespace

int main(int argc, char** argv) {
    keepFreedMemory();
    CLI::App app{"Identify mounts with elastomers and stops from recordings."};
    app.name(wems::programName(argv[0]));
    app.require_subcommand(1);
    app.set_help_all_flag("--help-all", "help of every command");
    app.set_version_flag("--version", "wems identify " WEMS_VERSION);
    wems::addCompletionOption(app);
    int exit_status = 0;
    wems::identify::cli::addRigidityCommand(app, exit_status);
    wems::identify::cli::addFitCommand(app, exit_status);
    wems::identify::cli::addSurfaceCommand(app, exit_status);
    wems::identify::cli::addCompareCommand(app, exit_status);
    wems::identify::cli::addDiagnoseCommand(app, exit_status);
    wems::identify::cli::addInspectCommand(app, exit_status);
    wems::identify::cli::addConvertCommand(app, exit_status);
    wems::identify::cli::addMergeCommand(app, exit_status);
    wems::identify::cli::addSingleAxisCommand(app, exit_status);
    wems::identify::cli::addBeamTipCommand(app, exit_status);
    try {
        app.parse(argc, argv);
        return exit_status;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const wems::InputError& error) {
        std::cerr << "identify: " << error.what() << "\n";
    } catch (const std::exception& error) {
        std::cerr << "identify: " << error.what() << "\n";
    }
    return 2;
}
