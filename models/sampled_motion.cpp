#include "models/sampled_motion.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace wems {
namespace {

// Intervals that differ by less are one: uniform times differ by the rounding of what is written.
constexpr double kSameInterval = 1e-9;

/// Displacement where the cubic through two samples with their velocities turns; the end's if it does not.
double findTurn(const AxisInterval& interval) {
    const auto [q0, v0, q1, v1, h] = interval;
    if (!(v0 * v1 < 0)) return q1;
    // v(p) = v0 + (v1 − v0) p + bulge p (1 − p) has one root in 0…1, since its signs there differ.
    const double bulge = 6 * ((q1 - q0) / h - 0.5 * (v0 + v1));
    const double a = -bulge, b = v1 - v0 + bulge;
    const double root = std::sqrt(b * b - 4 * a * v0), larger = -0.5 * (b + (b < 0 ? -root : root));
    double p = larger != 0 ? v0 / larger : 0;
    if (!(p >= 0 && p <= 1)) p = larger / a;
    const double rest = 1 - p;
    return (1 + 2 * p) * rest * rest * q0 + p * rest * rest * h * v0 + p * p * (3 - 2 * p) * q1 - p * p * rest * h * v1;
}

}  // namespace

std::vector<Reversal> findReversals(const Eigen::VectorXd& q, double fraction) {
    std::vector<Reversal> found;
    const double threshold = fraction * (q.maxCoeff() - q.minCoeff());
    if (threshold <= 0) return found;
    Eigen::Index low = 0, high = 0, extreme = 0;
    int direction = 0;  // unknown until the first clear travel
    for (Eigen::Index i = 1; i < q.size(); ++i) {
        if (direction == 0) {
            if (q[i] < q[low]) low = i;
            if (q[i] > q[high]) high = i;
            if (q[i] - q[low] > threshold) direction = 1;
            if (q[high] - q[i] > threshold) direction = -1;
            if (direction != 0) {
                const auto start = direction > 0 ? low : high;
                if (start > 0) found.push_back({start, direction});
                extreme = i;
            }
        } else if (direction * (q[i] - q[extreme]) > 0) {
            extreme = i;
        } else if (direction * (q[extreme] - q[i]) > threshold) {
            direction = -direction;
            found.push_back({extreme, direction});
            extreme = i;
        }
    }
    return found;
}

Eigen::VectorXd derive(const Eigen::VectorXd& values, double interval, int half_width, int order) {
    const Eigen::Index n = values.size();
    const Eigen::Index width = std::min<Eigen::Index>(2 * half_width + 1, n);
    Eigen::VectorXd result(n);
    // Weights of the parabola's derivative at every place inside a window; the middle one serves nearly all samples.
    Eigen::MatrixXd basis(width, 3);
    for (Eigen::Index i = 0; i < width; ++i) {
        const double s = static_cast<double>(i) - 0.5 * static_cast<double>(width - 1);
        basis.row(i) << 1.0, s, s * s;
    }
    const Eigen::MatrixXd weights = basis.completeOrthogonalDecomposition().pseudoInverse();  // 3 x width
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index start = std::clamp<Eigen::Index>(i - width / 2, 0, n - width);
        const double s = static_cast<double>(i - start) - 0.5 * static_cast<double>(width - 1);
        const Eigen::Vector3d c = weights * values.segment(start, width);
        result[i] = order == 1 ? (c[1] + 2.0 * c[2] * s) / interval : 2.0 * c[2] / (interval * interval);
    }
    return result;
}

int chooseHalfWidth(const Eigen::VectorXd& q) {
    const auto reversals = findReversals(q, 0.05);
    const auto swings = std::max<std::size_t>(reversals.size(), 2);
    const double period = 2.0 * static_cast<double>(q.size()) / static_cast<double>(swings);
    return std::clamp(static_cast<int>(std::lround(period / 60.0)), 2, 200);
}

void dragAlong(const AxisForce& force, const AxisInterval& interval, double* z) {
    if (force.shape().draggedCount() == 0) return;
    const double turn = findTurn(interval);
    force.dragStates(turn - interval.q0, z);
    if (turn != interval.q1) force.dragStates(interval.q1 - turn, z);
}

Eigen::VectorXd calcForceAlong(const AxisLaw& law, const Eigen::VectorXd& time, const Eigen::VectorXd& q,
                               const Eigen::VectorXd& v) {
    const AxisForce force(law);
    std::vector<double> z(force.stateCount(), 0.0);
    for (std::size_t b = 0; b < force.branches().size(); ++b) z[b] = q[0];
    Eigen::VectorXd result(q.size());
    std::vector<double> decay(force.branches().size(), 1.0);
    double decayed = 0;  // s, over which
    for (Eigen::Index k = 0; k < q.size(); ++k) {
        if (k > 0) {
            const double h = time[k] - time[k - 1], rate = (q[k] - q[k - 1]) / h;
            for (std::size_t b = 0; b < decay.size(); ++b) {
                const double tau = force.branches()[b].time_constant, lag = tau * rate;
                if (std::abs(h - decayed) > kSameInterval * h) decay[b] = std::exp(-h / tau);
                z[b] = q[k] - lag + (z[b] - q[k - 1] + lag) * decay[b];
            }
            decayed = h;
            dragAlong(force, {q[k - 1], v[k - 1], q[k], v[k], h}, z.data());
        }
        result[k] = force.calcForce(q[k], v[k], time[k] - time[0], z.data());
    }
    return result;
}

}  // namespace wems
