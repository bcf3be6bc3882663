#include "identify/fit/test_function.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/pi.hpp"

namespace wems::identify {
namespace {

/// Centred quintic B-spline and its derivatives from truncated powers: Σ (−1)^k C(6,k) (x + 3 − k)₊^n / n!, summed from
/// the nearer end of the support so that nothing cancels badly.
double calcSpline(double x, int derivative) {
    const double sign = x > 0 && derivative == 1 ? -1.0 : 1.0;
    const double y = 3 - std::abs(x);  // distance from the nearer end; the spline is even
    constexpr std::array<double, 4> binomial{1, -6, 15, -20};
    constexpr std::array<double, 3> factorial{120, 24, 6};
    double sum = 0;
    for (int k = 0; k < 4 && y > k; ++k) sum += binomial.at(k) * std::pow(y - k, 5 - derivative);
    return sign * sum / factorial.at(derivative);
}

}  // namespace

TestFunction::TestFunction(int knot_samples, double interval)
    : knot_samples_(std::max(1, knot_samples)), half_(3 * knot_samples_ - 1), interval_(interval) {
    const double h = knot_samples_;
    for (int j = -half_; j <= half_; ++j) {
        value_.push_back(calcSpline(j / h, 0) / h);
        first_.push_back(calcSpline(j / h, 1) / (h * h * interval_));
        second_.push_back(calcSpline(j / h, 2) / (h * h * h * interval_ * interval_));
    }
}

int TestFunction::stride() const {
    return std::max(1, knot_samples_ / 2);
}

int TestFunction::outputCount(int samples) const {
    return samples <= 2 * half_ ? 0 : (samples - 2 * half_ - 1) / stride() + 1;
}

double TestFunction::response(double frequency) const {
    const double x = kPi * frequency * knot_samples_ * interval_;
    return std::abs(x) < 1e-9 ? 1.0 : std::pow(std::sin(x) / x, 6);
}

}  // namespace wems::identify
