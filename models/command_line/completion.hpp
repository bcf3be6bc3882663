/// @file
/// Completion of an executable's command line in bash, made from the parser itself.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace wems {

/// A script for bash-completion: subcommands, the options of each, and the values of options that take one of a few;
/// files everywhere else.
/// @param program name under which the executable is installed
std::string formatBashCompletion(const CLI::App& app, const std::string& program);

/// Name under which a program was called, without folders.
std::string programName(const std::string& call);

/// Adds the hidden option `--completion PROGRAM`, which prints that script in place of anything else (as
/// CallForVersion).
void addCompletionOption(CLI::App& app);

}  // namespace wems
