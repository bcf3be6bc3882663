#include "identify/problem/path_derivative.hpp"

#include <cmath>
#include <cstddef>

#include "models/sampled_motion.hpp"

namespace wems::identify {
namespace {

/// Of the RMS of the motion: small beside any knee, large beside round-off.
constexpr double kDifference = 1e-6;

double calcRms(const Eigen::VectorXd& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace

PathDerivative::PathDerivative(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                               double interval) {
    AxisLaw dragged = law;
    dragged.stops.clear();
    if (dragged.friction && !dragged.friction->presliding_stiffness) dragged.friction.reset();
    const AxisForce force(dragged);
    const std::size_t count = force.shape().draggedCount(), first = force.branches().size();
    const double displacement = kDifference * calcRms(q), velocity = kDifference * calcRms(v);
    if (count == 0 || !(displacement > 0) || !(velocity > 0)) return;
    const Eigen::Index samples = q.size();
    states_.assign(count, std::vector<Step>(static_cast<std::size_t>(samples)));
    std::vector<double> state(static_cast<std::size_t>(force.stateCount()), 0.0), moved;
    for (Eigen::Index k = 0; k < samples; ++k) {
        const auto i = static_cast<std::size_t>(k);
        if (k > 0) {
            const std::vector<double> before = state;
            const std::array<double, 4> ends{q[k - 1], v[k - 1], q[k], v[k]};
            const auto drag = [&](const std::array<double, 4>& at, std::vector<double>& z) {
                dragAlong(force, {at[0], at[1], at[2], at[3], interval}, z.data());
            };
            drag(ends, state);
            moved = before;
            for (double& value : moved) value += displacement;
            drag(ends, moved);
            for (std::size_t j = 0; j < count; ++j)
                states_[j][i].kept = (moved[first + j] - state[first + j]) / displacement;
            for (std::size_t end = 0; end < ends.size(); ++end) {
                const double change = end % 2 == 0 ? displacement : velocity;
                std::array<double, 4> at = ends;
                at[end] += change;
                moved = before;
                drag(at, moved);
                for (std::size_t j = 0; j < count; ++j)
                    states_[j][i].by_ends[end] = (moved[first + j] - state[first + j]) / change;
            }
        }
        const double here = force.calcForce(q[k], v[k], 0, state.data());
        for (std::size_t j = 0; j < count; ++j) {
            moved = state;
            moved[first + j] += displacement;
            states_[j][i].force = (force.calcForce(q[k], v[k], 0, moved.data()) - here) / displacement;
        }
    }
}

Eigen::VectorXd PathDerivative::apply(const Eigen::Ref<const Eigen::VectorXd>& q,
                                      const Eigen::Ref<const Eigen::VectorXd>& v) const {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(q.size());
    for (const std::vector<Step>& steps : states_) {
        double state = 0;
        for (Eigen::Index k = 0; k < q.size(); ++k) {
            const Step& step = steps[static_cast<std::size_t>(k)];
            if (k > 0)
                state = step.kept * state + step.by_ends[0] * q[k - 1] + step.by_ends[1] * v[k - 1] +
                        step.by_ends[2] * q[k] + step.by_ends[3] * v[k];
            change[k] += step.force * state;
        }
    }
    return change;
}

}  // namespace wems::identify
