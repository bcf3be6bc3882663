#include "identify/problem/sliding_friction.hpp"

#include <algorithm>
#include <cmath>

namespace wems::identify {
namespace {

constexpr double kSaturated = 20;  // |v|/v_t from which tanh is ±1 in double precision

/// ln(2 cosh x), without overflow.
double calcLogCosh(double x) {
    return std::abs(x) + std::log1p(std::exp(-2 * std::abs(x)));
}

/// Mean of tanh while its argument goes from one value to another at a constant rate.
double calcMeanTanh(double from, double to) {
    if (std::min(from, to) > kSaturated) return 1;
    if (std::max(from, to) < -kSaturated) return -1;
    if (std::abs(to - from) < 1e-3) return std::tanh(0.5 * (from + to));
    return (calcLogCosh(to) - calcLogCosh(from)) / (to - from);
}

}  // namespace

Eigen::VectorXd calcSlidingDirection(const Eigen::VectorXd& v, double transition_velocity) {
    const Eigen::VectorXd x = v / transition_velocity;
    const Eigen::Index count = x.size();
    Eigen::VectorXd mean(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        const double before = k > 0 ? 0.5 * (x[k - 1] + x[k]) : x[k];
        const double after = k + 1 < count ? 0.5 * (x[k] + x[k + 1]) : x[k];
        mean[k] = 0.5 * (calcMeanTanh(before, x[k]) + calcMeanTanh(x[k], after));
    }
    // A mean over an interval h takes h²/24 of the second derivative from a signal.
    Eigen::VectorXd result = mean;
    for (Eigen::Index k = 1; k + 1 < count; ++k) result[k] -= (mean[k - 1] - 2 * mean[k] + mean[k + 1]) / 24;
    return result;
}

}  // namespace wems::identify
