/// @file
/// Runs a program of the build tree and collects what a user sees of it.
#pragma once

#include <string>
#include <vector>

namespace wems::test {

struct ProgramResult {
    int exit_status = -1;  ///< 128 + signal if it was killed
    std::string output;    ///< standard output
    std::string errors;    ///< standard error
};

/// Runs `program` with `arguments` in the folder `directory`.
ProgramResult runProgram(const std::string& program, const std::vector<std::string>& arguments,
                         const std::string& directory);

/// A new empty folder that goes with the object.
class TemporaryDirectory {
public:
    TemporaryDirectory();
    ~TemporaryDirectory();
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

    const std::string& path() const { return path_; }
    /// Writes a file into the folder and returns its name.
    std::string write(const std::string& name, const std::string& text) const;
    /// Names of all files in the folder, sorted.
    std::vector<std::string> list() const;

private:
    std::string path_;
};

}  // namespace wems::test
