/// @file
/// The times of a recording's rows.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace wems::plugin {

/// Increasing times, s: listed one by one, or k/rate, which takes no memory.
class SampleTimes {
public:
    SampleTimes() = default;
    SampleTimes(std::vector<double> times) : listed_(std::move(times)) {}  // NOLINT: a list is such times
    static SampleTimes makeUniform(double rate, std::size_t count) {
        SampleTimes times;
        times.rate_ = rate;
        times.count_ = count;
        return times;
    }

    void push_back(double time) { listed_.push_back(time); }
    std::size_t size() const { return listed_.size() + count_; }
    bool empty() const { return size() == 0; }
    double operator[](std::size_t k) const { return count_ > 0 ? static_cast<double>(k) / rate_ : listed_[k]; }
    double back() const { return (*this)[size() - 1]; }

private:
    std::vector<double> listed_;
    double rate_ = 1;
    std::size_t count_ = 0;  // of uniform times; none are listed then
};

}  // namespace wems::plugin
