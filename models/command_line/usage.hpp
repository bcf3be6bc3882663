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

}  // namespace wems
