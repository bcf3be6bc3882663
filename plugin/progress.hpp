/// @file
/// Progress of a long run on a terminal.
#pragma once

#include <chrono>
#include <string>

namespace wems::plugin {

/// One line on standard error that is overwritten a few times a second: what has been done, how fast, the time left.
/// Writes nothing where standard error is not a terminal, nor within the first second.
class Progress {
public:
    explicit Progress(bool wanted);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// @param fraction done, 0 to 1
    /// @param what     where the run is, such as `t = 12.3 s`
    void show(double fraction, const std::string& what);
    /// True where show() would write now; spares its caller the text otherwise.
    bool due() const;

private:
    bool wanted_, shown_ = false;
    std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace wems::plugin
