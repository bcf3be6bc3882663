#include "tests/hidden/run_plan.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "models/common/units.hpp"
#include "models/excitation.hpp"

namespace wems::hidden {
namespace {

std::unique_ptr<Signal> makeSignal(const RunPlan& plan, std::uint64_t seed) {
    const double from = plan.upward ? kLowest : kHighest, to = plan.upward ? kHighest : kLowest;
    constexpr Fade fade{0.2, 0.2};
    switch (plan.excitation) {
        case Excitation::logarithmic:
            return makeLogarithmicSweep(from, to, 60 * std::log2(kHighest / kLowest) / plan.duration);
        case Excitation::linear:
            return makeLinearSweep(from, to, (kHighest - kLowest) / plan.duration, fade);
        case Excitation::random:
            break;
    }
    return makeBandLimitedRandom(kLowest, kHighest, plan.duration, seed, fade);
}

/// Classical Runge–Kutta for x'' + 2 ζ Ω x' + Ω² x = s; the signal becomes x''.
void moveTable(RunPlan& plan) {
    constexpr double omega = 0.3 * kTwoPi * kLowest, zeta = 0.7, h = 1 / kTableRate;
    const Eigen::Index n = plan.signal.size();
    const Eigen::RowVectorXd drive = resample(plan.signal.transpose(), kTableRate, 2 * kTableRate, 2 * n - 1);
    const auto accelerate = [&](double s, const Eigen::Vector2d& y) {
        return s - 2 * zeta * omega * y[1] - omega * omega * y[0];
    };
    const auto rates = [&](double s, const Eigen::Vector2d& y) { return Eigen::Vector2d(y[1], accelerate(s, y)); };
    Eigen::Vector2d y(0, 0);
    plan.travel.resize(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        plan.travel[k] = y[0];
        plan.signal[k] = accelerate(drive[2 * k], y);
        if (k + 1 == n) break;
        const Eigen::Vector2d k1 = rates(drive[2 * k], y), k2 = rates(drive[2 * k + 1], y + 0.5 * h * k1),
                              k3 = rates(drive[2 * k + 1], y + 0.5 * h * k2), k4 = rates(drive[2 * k + 2], y + h * k3);
        y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
}

}  // namespace

std::string formatExcitation(const RunPlan& plan) {
    if (plan.excitation == Excitation::random) return "random";
    return std::string(plan.excitation == Excitation::linear ? "linear" : "logarithmic") + " sweep " +
           (plan.upward ? "up" : "down");
}

void tabulate(RunPlan& plan, bool table, std::uint64_t seed) {
    const auto signal = makeSignal(plan, seed);
    const auto n = static_cast<Eigen::Index>(plan.duration * kTableRate);
    plan.signal.resize(n);
    plan.frequency.resize(plan.excitation == Excitation::random ? 0 : n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const double t = static_cast<double>(k) / kTableRate;
        plan.signal[k] = signal->value(t);
        if (plan.frequency.size() > 0) plan.frequency[k] = signal->frequency(t);
    }
    if (table) moveTable(plan);
}

Eigen::MatrixXd resample(const Eigen::MatrixXd& rows, double from_rate, double to_rate, Eigen::Index count) {
    const Eigen::Index n = rows.cols();
    Eigen::MatrixXd slopes(rows.rows(), n), result(rows.rows(), count);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Eigen::Index before = std::max<Eigen::Index>(0, k - 1), after = std::min(n - 1, k + 1);
        if (k >= 2 && k + 2 < n)
            slopes.col(k) = (rows.col(k - 2) - 8 * rows.col(k - 1) + 8 * rows.col(k + 1) - rows.col(k + 2)) / 12;
        else
            slopes.col(k) = (rows.col(after) - rows.col(before)) / static_cast<double>(after - before);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
        const double at = std::min(static_cast<double>(n - 1), static_cast<double>(i) * from_rate / to_rate);
        const auto k = std::min(n - 2, static_cast<Eigen::Index>(at));
        const double s = at - static_cast<double>(k);
        result.col(i) = (1 + 2 * s) * (1 - s) * (1 - s) * rows.col(k) + s * (1 - s) * (1 - s) * slopes.col(k) +
                        s * s * (3 - 2 * s) * rows.col(k + 1) + s * s * (s - 1) * slopes.col(k + 1);
    }
    return result;
}

}  // namespace wems::hidden
