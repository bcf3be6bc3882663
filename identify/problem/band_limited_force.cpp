#include "identify/problem/band_limited_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wems::identify {
namespace {

/// From means over the interval around each sample: such a mean takes h²/24 of the second derivative from a signal.
Eigen::VectorXd restoreCurvature(const Eigen::VectorXd& mean) {
    Eigen::VectorXd result = mean;
    for (Eigen::Index k = 1; k + 1 < mean.size(); ++k) result[k] -= (mean[k - 1] - 2 * mean[k] + mean[k + 1]) / 24;
    return result;
}

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

/// How that mean answers to both ends of the argument.
std::array<double, 2> calcMeanTanhSlopes(double from, double to) {
    if (std::min(from, to) > kSaturated || std::max(from, to) < -kSaturated) return {0, 0};
    if (std::abs(to - from) < 1e-3) {
        const double tanh = std::tanh(0.5 * (from + to)), half = 0.5 * (1 - tanh * tanh);
        return {half, half};
    }
    const double mean = calcMeanTanh(from, to);
    return {(mean - std::tanh(from)) / (to - from), (std::tanh(to) - mean) / (to - from)};
}

/// Equal pieces that each half of an interval is summed over: what an edge still errs by falls with the square of their
/// number, to a 256th of what samples alone give.
constexpr int kOfHalf = 8, kOfInterval = 2 * kOfHalf;

/// The cubic through both ends of an interval with their slopes, and its rate, at a place p = 0 … 1.
struct CubicWeights {
    double q[4];  ///< weights of q0, h v0, q1, h v1 in q
    double v[4];  ///< the same in h v
};
CubicWeights makeCubicWeights(double p) {
    const double r = 1 - p;
    return {{(1 + 2 * p) * r * r, p * r * r, p * p * (3 - 2 * p), -p * p * r},
            {-6 * p * r, r * (1 - 3 * p), 6 * p * r, p * (3 * p - 2)}};
}
double weigh(const double* weights, const double* ends) {
    return weights[0] * ends[0] + weights[1] * ends[1] + weights[2] * ends[2] + weights[3] * ends[3];
}

/// The stops of a law that push, alone.
AxisLaw takeStops(const AxisLaw& law) {
    AxisLaw stops;
    stops.offset = law.offset;
    for (const Stop& stop : law.stops)
        if (stop.stiffness != 0) stops.stops.push_back(stop);
    return stops;
}

/// Calls `visit(k, ends)` for the intervals, from sample k on, in which a stop may be touched; ends: q0, h v0, q1, h
/// v1.
template <typename Visit>
void visitTouches(const AxisLaw& stops, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double interval,
                  const Visit& visit) {
    // Between these no stop is reached.
    double lower = -std::numeric_limits<double>::infinity(), upper = -lower;
    for (const Stop& stop : stops.stops) {
        if (stop.side == Side::positive) upper = std::min(upper, stop.clearance - stops.offset);
        if (stop.side == Side::negative) lower = std::max(lower, -stop.clearance - stops.offset);
    }
    for (Eigen::Index k = 0; k + 1 < q.size(); ++k) {
        const double ends[4] = {q[k], interval * v[k], q[k + 1], interval * v[k + 1]};
        // The cubic leaves the straight line by at most 4/27 of what its slopes differ from it.
        const double line = ends[2] - ends[0];
        const double bulge = 4.0 / 27 * (std::abs(ends[1] - line) + std::abs(ends[3] - line));
        if (std::max(ends[0], ends[2]) + bulge > upper || std::min(ends[0], ends[2]) - bulge < lower) visit(k, ends);
    }
}

/// Of the first and the last sample half an interval is known.
void completeEnds(Eigen::VectorXd& mean) {
    mean[0] *= 2;
    mean[mean.size() - 1] *= 2;
}

/// Of the middles of an interval's pieces.
std::array<CubicWeights, kOfInterval> makeMiddles() {
    std::array<CubicWeights, kOfInterval> middles{};
    for (int i = 0; i < kOfInterval; ++i)
        middles[static_cast<std::size_t>(i)] = makeCubicWeights((i + 0.5) / kOfInterval);
    return middles;
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
    return restoreCurvature(mean);
}

SlidingDerivative::SlidingDerivative(const Eigen::VectorXd& v, double transition_velocity) {
    const Eigen::VectorXd x = v / transition_velocity;
    const Eigen::Index count = x.size();
    weights_.setZero(3, count);
    for (Eigen::Index k = 0; k < count; ++k) {
        const bool first = k == 0, last = k + 1 == count;
        const double before = first ? x[k] : 0.5 * (x[k - 1] + x[k]), after = last ? x[k] : 0.5 * (x[k] + x[k + 1]);
        const std::array<double, 2> rising = calcMeanTanhSlopes(before, x[k]),
                                    falling = calcMeanTanhSlopes(x[k], after);
        if (!first) weights_(0, k) = 0.25 * rising[0];
        weights_(1, k) =
            (first ? 0.5 : 0.25) * rising[0] + 0.5 * rising[1] + 0.5 * falling[0] + (last ? 0.5 : 0.25) * falling[1];
        if (!last) weights_(2, k) = 0.25 * falling[1];
    }
    weights_ /= transition_velocity;
}

Eigen::VectorXd SlidingDerivative::apply(const Eigen::Ref<const Eigen::VectorXd>& v) const {
    const Eigen::Index count = weights_.cols();
    Eigen::VectorXd mean(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        mean[k] = weights_(1, k) * v[k];
        if (k > 0) mean[k] += weights_(0, k) * v[k - 1];
        if (k + 1 < count) mean[k] += weights_(2, k) * v[k + 1];
    }
    return restoreCurvature(mean);
}

Eigen::VectorXd calcStopForce(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double interval) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(q.size());
    const AxisLaw stops = takeStops(law);
    if (q.size() == 0 || stops.stops.empty()) return mean;
    const std::array<CubicWeights, kOfInterval> middles = makeMiddles();
    const AxisForce force(stops);
    visitTouches(stops, q, v, interval, [&](Eigen::Index k, const double* ends) {
        for (int i = 0; i < kOfInterval; ++i) {
            const CubicWeights& at = middles[static_cast<std::size_t>(i)];
            mean[i < kOfHalf ? k : k + 1] +=
                force.calcForce(weigh(at.q, ends), weigh(at.v, ends) / interval, 0, nullptr) / kOfInterval;
        }
    });
    completeEnds(mean);
    return restoreCurvature(mean);
}

Eigen::VectorXd calcStopStiffness(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                  double interval) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(q.size());
    const AxisLaw stops = takeStops(law);
    if (q.size() == 0 || stops.stops.empty()) return mean;
    std::array<CubicWeights, kOfInterval + 1> edges{};
    for (int i = 0; i <= kOfInterval; ++i)
        edges[static_cast<std::size_t>(i)] = makeCubicWeights(static_cast<double>(i) / kOfInterval);
    const AxisForce force(stops);
    visitTouches(stops, q, v, interval, [&](Eigen::Index k, const double* ends) {
        double before = ends[0], force_before = force.calcStaticForce(before);
        for (int i = 0; i < kOfInterval; ++i) {
            const double after = weigh(edges[static_cast<std::size_t>(i) + 1].q, ends);
            const double force_after = force.calcStaticForce(after), travel = after - before;
            mean[i < kOfHalf ? k : k + 1] +=
                (travel != 0 ? (force_after - force_before) / travel : force.calcStaticStiffness(before)) / kOfInterval;
            before = after;
            force_before = force_after;
        }
    });
    completeEnds(mean);
    return mean;
}

StopDerivative::StopDerivative(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double interval)
    : interval_(interval) {
    const AxisLaw stops = takeStops(law);
    if (q.size() == 0 || stops.stops.empty()) return;
    const std::array<CubicWeights, kOfInterval> middles = makeMiddles();
    const AxisForce force(stops);
    visitTouches(stops, q, v, interval, [&](Eigen::Index k, const double* ends) {
        Touch touch{k, {}};
        bool touched = false;
        for (int i = 0; i < kOfInterval; ++i) {
            const CubicWeights& at = middles[static_cast<std::size_t>(i)];
            const double here = weigh(at.q, ends), rate = weigh(at.v, ends) / interval;
            const double stiffness = force.calcStiffness(here, rate, 0, nullptr),
                         damping = force.calcDamping(here, rate, 0, nullptr);
            touched = touched || stiffness != 0 || damping != 0;
            double* weights = touch.weight[i < kOfHalf ? 0 : 1];
            for (int e = 0; e < 4; ++e)
                weights[e] += (stiffness * at.q[e] + damping / interval * at.v[e]) / kOfInterval;
        }
        if (touched) touches_.push_back(touch);
    });
}

Eigen::VectorXd StopDerivative::apply(const Eigen::Ref<const Eigen::VectorXd>& q,
                                      const Eigen::Ref<const Eigen::VectorXd>& v) const {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(q.size());
    if (touches_.empty()) return mean;
    for (const Touch& touch : touches_) {
        const Eigen::Index k = touch.first;
        const double ends[4] = {q[k], interval_ * v[k], q[k + 1], interval_ * v[k + 1]};
        mean[k] += weigh(touch.weight[0], ends);
        mean[k + 1] += weigh(touch.weight[1], ends);
    }
    completeEnds(mean);
    return restoreCurvature(mean);
}

}  // namespace wems::identify
