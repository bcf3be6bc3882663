#include "models/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace wems {
namespace {
constexpr std::chrono::milliseconds silence{1000}, interval{200};
}

Progress::Progress(bool wanted)
    : wanted_(wanted && isatty(STDERR_FILENO) != 0), start_(std::chrono::steady_clock::now()), last_(start_) {}

Progress::~Progress() {
    if (shown_) std::fputs("\r\033[K", stderr);
}

bool Progress::due() const {
    if (!wanted_) return false;
    const auto now = std::chrono::steady_clock::now();
    return now - start_ > silence && now - last_ > interval;
}

void Progress::show(double fraction, const std::string& what) {
    if (!due()) return;
    last_ = std::chrono::steady_clock::now();
    const double spent = std::chrono::duration<double>(last_ - start_).count();
    const double left = fraction > 0 ? spent * (1 - fraction) / fraction : 0;
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "%3.0f %%, %.0f s left: ", 100 * fraction, left);
    write(numbers + what);
}

void Progress::step(const std::string& what) {
    if (!wanted_) return;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    char time[32];
    std::snprintf(time, sizeof time, "%3.0f s: ", spent);
    write(time + what);
}

void Progress::write(const std::string& line) {
    shown_ = true;
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
}

}  // namespace wems
