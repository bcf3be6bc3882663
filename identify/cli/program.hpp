/// @file
/// The executable `identify` without what belongs to its process, so that others can call whole commands.
#pragma once

namespace wems::identify::cli {

/// Runs a command line. @returns the exit status, 0 or 1
/// @throws InputError on bad input and usage; nothing is written then
int runIdentify(int argc, char** argv);

}  // namespace wems::identify::cli
