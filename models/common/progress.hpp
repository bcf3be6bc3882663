/// @file
/// Progress of a long run on a terminal.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace wems {

/// A step of a long computation, told as it begins.
struct ProgressEvent {
    std::string what;  ///< plain words, such as `motion of both parts`
    /// Parts of the whole time between which it usually lies; 0 and 1: not known.
    double from = 0, to = 1;
};
/// Told by the thread that computes. What it throws ends the computation.
using ProgressListener = std::function<void(const ProgressEvent&)>;

/// One line on standard error that is overwritten: what is being done, the time spent and, as far as it can be told,
/// the time left. It goes with the object. Writes nothing where standard error is not a terminal.
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
    /// A step that tells nothing until it is over, shown at once; its times go on by themselves, once a second. The
    /// time left follows from what the steps before took.
    void step(const ProgressEvent& event);

private:
    using Clock = std::chrono::steady_clock;

    double spent() const;
    void keepWriting();
    void writeStep();
    void write(const std::string& line);

    bool wanted_, shown_ = false;
    Clock::time_point start_, last_;

    std::mutex mutex_;  // of all below and of writing
    std::condition_variable ended_;
    bool over_ = false;
    std::string what_;
    double whole_ = 0;    // s, expected; 0: not known
    double later_ = 0;    // s, expected after the present step
    std::thread writer_;  // from the first step on
};

}  // namespace wems
