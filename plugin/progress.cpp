#include "plugin/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace wems::plugin {
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
    shown_ = true;
    const double spent = std::chrono::duration<double>(last_ - start_).count();
    const double left = fraction > 0 ? spent * (1 - fraction) / fraction : 0;
    std::fprintf(stderr, "\r\033[K%3.0f %%  %s, %.0f s left", 100 * fraction, what.c_str(), left);
    std::fflush(stderr);
}

}  // namespace wems::plugin
