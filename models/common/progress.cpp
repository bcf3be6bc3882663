#include "models/common/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace wems {
namespace {
constexpr std::chrono::milliseconds silent_at_first{1000}, between_lines{200}, between_steps{1000};
}

Progress::Progress(bool wanted) : wanted_(wanted && isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        over_ = true;
    }
    ended_.notify_all();
    if (writer_.joinable()) writer_.join();
    if (shown_) std::fputs("\r\033[K", stderr);
}

bool Progress::due() const {
    if (!wanted_) return false;
    const auto now = Clock::now();
    return now - start_ > silent_at_first && now - last_ > between_lines;
}

double Progress::spent() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::show(double fraction, const std::string& what) {
    if (!due()) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    what_.clear();  // the step before is over
    last_ = Clock::now();
    const double left = fraction > 0 ? spent() * (1 - fraction) / fraction : 0;
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "%3.0f %%, %.0f s left: ", 100 * fraction, left);
    write(numbers + what);
}

void Progress::step(const ProgressEvent& event) {
    if (!wanted_) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    what_ = event.what;
    whole_ = event.from > 0 ? spent() / event.from : 0;
    later_ = whole_ * (1 - event.to);
    writeStep();
    if (!writer_.joinable()) writer_ = std::thread([this] { keepWriting(); });
}

void Progress::keepWriting() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, between_steps, [this] { return over_; })) writeStep();
}

void Progress::writeStep() {
    if (what_.empty()) return;
    const double now = spent();
    char time[64];
    if (whole_ > 0) {
        std::snprintf(time, sizeof time, "%3.0f s, about %.0f s left: ", now, std::max(whole_ - now, later_));
    } else {
        std::snprintf(time, sizeof time, "%3.0f s: ", now);
    }
    write(time + what_);
}

void Progress::write(const std::string& line) {
    shown_ = true;
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
}

}  // namespace wems
