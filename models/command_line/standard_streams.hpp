/// @file
/// Standard output and standard error of an executable.
#pragma once

namespace wems {

/// At the start of main(): a reader of standard output that goes away is an error of writing, no signal; a standard
/// stream that is closed does not lend its number to a file that is opened later; a file that becomes shorter while it
/// is read in blocks ends the program with one line and the status 2.
void prepareStandardStreams();

/// Hands over what was printed so far. @throws InputError if standard output does not take it, such as a full disk or a
/// pipe that nobody reads.
void flushStandardOutput();

/// The end of an executable: `work` returns its exit status. Whatever it throws, and an error of standard output,
/// becomes one line `program: …` on standard error and the status 2.
int runProgram(const char* program, int (*work)(int argc, char** argv), int argc, char** argv);

}  // namespace wems
