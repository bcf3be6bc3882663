/// @file
/// Wall-clock time of the steps of a computation.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace wems::identify {

class Stopwatch {
public:
    /// Steps are appended to `laps`, in seconds.
    explicit Stopwatch(std::vector<std::pair<std::string, double>>& laps) : laps_(laps) {}
    void lap(const std::string& name) {
        const auto now = std::chrono::steady_clock::now();
        laps_.emplace_back(name, std::chrono::duration<double>(now - last_).count());
        last_ = now;
    }
    /// The next step begins now.
    void restart() { last_ = std::chrono::steady_clock::now(); }

private:
    std::vector<std::pair<std::string, double>>& laps_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace wems::identify
