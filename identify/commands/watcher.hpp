/// @file
/// Who follows a command at work: a terminal, a notebook.
#pragma once

#include <string>
#include <vector>

namespace wems::identify::commands {

/// Told by the thread that called the command. What it throws ends the command.
class Watcher {
public:
    Watcher() = default;
    virtual ~Watcher() = default;
    Watcher(const Watcher&) = delete;
    Watcher& operator=(const Watcher&) = delete;

    /// All files that the command reads, before anything is computed.
    virtual void onInputs(const std::vector<std::string>& /*files*/) {}
    /// A step begins. @param from, to parts of the whole time between which it usually lies; 0 and 1: not known
    virtual void onStep(const std::string& /*what*/, double /*from*/ = 0, double /*to*/ = 1) {}
    /// A step that can tell how far it is. @param done 0 to 1
    virtual void onProgress(double /*done*/, const std::string& /*what*/) {}
};

}  // namespace wems::identify::commands
