/// @file
/// The one exception that bad input raises, everywhere in the project.
#pragma once

#include <stdexcept>
#include <string>

namespace wems {

/// Where in an input the problem sits. Empty or zero fields are left out of the message.
struct InputLocation {
    std::string file;  ///< path as the user gave it
    long line = 0;     ///< from 1; for a recording the row of the file, header and comments counted
    std::string key;   ///< TOML key such as `connection[2].z.stops[0].clearance`, column name, or command-line option
};

/// Input that the program cannot use: a file, a value, an option. Executables print `what()` on one line and exit
/// with status 2. The message reads `file:line: key: problem (accepted: …)`.
class InputError : public std::runtime_error {
public:
    /// @param problem  what is wrong, with the offending value
    /// @param accepted what would be accepted; empty if the problem says it already
    InputError(InputLocation location, const std::string& problem, const std::string& accepted = {});

    const InputLocation& location() const { return location_; }
    const std::string& problem() const { return problem_; }
    const std::string& accepted() const { return accepted_; }

private:
    InputLocation location_;
    std::string problem_, accepted_;
};

}  // namespace wems
