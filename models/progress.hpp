/// @file
/// Progress of a long run on a terminal.
#pragma once

#include <chrono>
#include <string>

namespace wems {

/// One line on standard error that is overwritten: what is being done and the time left. It goes with the object.
/// Writes nothing where standard error is not a terminal.
class Progress {
public:
    explicit Progress(bool wanted);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// A few times a second, and not within the first one.
    /// @param fraction done, 0 to 1
    /// @param what     where the run is, such as `t = 12.3 s`
    void show(double fraction, const std::string& what);
    /// True where show() would write now; spares its caller the text otherwise.
    bool due() const;
    /// At once, for steps whose length is not known beforehand: the step and the time spent so far.
    void step(const std::string& what);

private:
    void write(const std::string& line);

    bool wanted_, shown_ = false;
    std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace wems
