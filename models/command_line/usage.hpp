/// @file
/// What the executables say about a command line that they cannot use, in one line; options that are checked early.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace wems {

/// What is wrong with a command line, and which help lists what is accepted.
std::string describeUsageError(const CLI::App& app, const CLI::ParseError& error);

/// Accepts a number above zero.
CLI::Validator isPositive();
/// Accepts a number that is not below zero.
CLI::Validator isNonNegative();

/// An option or positional for a file or several to read.
template <typename Files>
CLI::Option* addInputFile(CLI::App& app, const std::string& name, Files& files, const std::string& help) {
    return app.add_option(name, files, help)->type_name("FILE");
}

/// An option for a file to write. That it can be written, and is no other file of the command line, is seen before
/// anything is computed.
/// @param dash_is_output whether `-` stands for standard output
CLI::Option* addOutputFile(CLI::App& app, const std::string& name, std::string& file, const std::string& help,
                           bool dash_is_output = false);

// Completion of an executable's command line in bash, made from the parser itself.

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
