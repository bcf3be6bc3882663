/// @file
/// The parts of the module.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "identify/commands/recordings.hpp"

namespace wems::python {

namespace py = pybind11;

/// The commands of `identify` and the fast forward model.
void bindCommands(py::module_& module);

// A command at work under an interpreter: its lock is released, Ctrl-C and the caller's progress function are heard.

namespace py = pybind11;

/// Ends the work; never seen by the caller.
struct Stopped : std::exception {};

/// Collects what the work says until the interpreter asks for it.
class Listener : public identify::commands::Watcher {
public:
    using Event = std::pair<std::string, double>;  ///< what, share of the whole done (0: not known)

    void onStep(const ProgressEvent& step) override { say(step.what, step.from); }
    void onProgress(double done, const std::string& what) override { say(what, done); }
    void stop() { stopped_ = true; }
    bool stopped() const { return stopped_; }
    std::vector<Event> take() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return std::exchange(events_, {});
    }

private:
    void say(const std::string& what, double done) {
        if (stopped_) throw Stopped();
        const std::lock_guard<std::mutex> lock(mutex_);
        events_.emplace_back(what, done);
    }

    std::atomic<bool> stopped_ = false;
    std::mutex mutex_;
    std::vector<Event> events_;
};

/// Runs `work(listener)` on a thread of its own. Whatever a signal's handler or `progress(what, done)` raises ends the
/// work at its next step and is raised then.
template <class Work>
auto follow(const py::object& progress, Work work) {
    constexpr std::chrono::milliseconds interval(50);
    Listener listener;
    std::exception_ptr raised;
    py::gil_scoped_release released;
    auto answer = std::async(std::launch::async, [&] { return work(listener); });
    while (answer.wait_for(interval) != std::future_status::ready) {
        if (listener.stopped()) continue;
        const py::gil_scoped_acquire acquired;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            for (const auto& [what, done] : listener.take())
                if (!progress.is_none()) progress(what, done);
        } catch (...) {
            raised = std::current_exception();
            listener.stop();
        }
    }
    if (!raised) {
        const py::gil_scoped_acquire acquired;
        for (const auto& [what, done] : listener.take())
            if (!progress.is_none()) progress(what, done);
        return answer.get();
    }
    try {
        answer.get();
    } catch (...) {  // what was raised comes first
    }
    std::rethrow_exception(raised);
}

}  // namespace wems::python
