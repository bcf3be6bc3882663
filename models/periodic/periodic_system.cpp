#include "models/periodic/periodic_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/error.hpp"
#include "models/load_gain.hpp"
#include "models/mount_forces.hpp"
#include "models/static_sag.hpp"

namespace wems {
namespace {

bool isNonlinear(const AxisLaw& law) {
    return !law.stops.empty() || law.cubic != 0 || (law.friction && law.friction->force > 0);
}

}  // namespace

NonlinearAxis::NonlinearAxis(int connection, int axis, const AxisForce& force, double rest)
    : connection_(connection), axis_(axis), force_(force), rest_(rest) {
    const std::array<double, kMostStates> relaxed = [&] {
        std::array<double, kMostStates> z{};
        z.fill(rest);
        return z;
    }();
    rest_force_ = force.calcStaticForce(rest);
    stiffness_ = force.calcStaticStiffness(rest);
    damping_ = force.calcDamping(rest, 0, 0, relaxed.data());
    for (const MaxwellBranch& branch : force.branches()) branches_ += branch.stiffness;
}

NonlinearAxis::Value NonlinearAxis::calcValue(double q, double v, double half) const {
    // Branches whose dashpots follow q carry nothing: they belong to the linear part.
    std::array<double, kMostStates> relaxed{};
    relaxed.fill(rest_ + q);
    const double* z = relaxed.data();
    Value value{force_.calcForce(rest_ + q, v, 0, z) - rest_force_ - stiffness_ * q - damping_ * v,
                force_.calcStiffness(rest_ + q, v, 0, z) - branches_ - stiffness_,
                force_.calcDamping(rest_ + q, v, 0, z) - damping_};
    const double w = std::abs(v) * half;
    for (const Stop& stop : force_.law().stops) {
        const double direction = stop.side == Side::positive ? 1 : -1;
        const double depth = direction * (rest_ + q + force_.law().offset) - stop.clearance;
        if (!(std::abs(depth) < w)) continue;
        // What the mean has beyond max(0, depth), and its derivatives by depth and w.
        const double beyond = (depth + w) * (depth + w) / (4 * w) - std::max(0.0, depth);
        const double by_depth = (depth + w) / (2 * w) - (depth > 0 ? 1 : 0);
        const double by_w = (depth + w) * (w - depth) / (4 * w * w);
        const double factor = 1 + stop.dissipation * direction * v;
        const double k = direction * stop.stiffness * std::max(0.0, factor);
        value.force += k * beyond;
        value.stiffness += k * direction * by_depth;
        value.damping += k * by_w * half * (v < 0 ? -1 : 1);
        if (factor > 0) value.damping += stop.stiffness * stop.dissipation * beyond;
    }
    return value;
}

PeriodicSystem::PeriodicSystem(const MountModel& model, const HarmonicInput& input)
    : model_(model), input_(input), linear_(linearizeExactly(model)), rest_(findStaticSag(model).relative) {
    const MountForces laws(model);
    for (int i = 0; i < laws.connectionCount(); ++i)
        for (int k = 0; k < 3; ++k) {
            const AxisForce& force = laws.axis(i, k);
            const std::string place = "connection[" + std::to_string(i) + "]." + "xyz"[k];
            if (force.shape().bristle)
                throw InputError({"", 0, place + ".friction"},
                                 "has presliding, whose force depends on all that went before",
                                 "friction without presliding_stiffness, or a simulation in time");
            if (force.shape().hystereses > 0)
                throw InputError({"", 0, place + (force.law().hysteresis ? ".hysteresis" : ".sliders")},
                                 "its force depends on all that went before",
                                 "a law without it, or a simulation in time");
            if (isNonlinear(force.law())) axes_.emplace_back(i, k, force, rest_(k, i));
        }
    // A linear model is answered by the same methods: one axis, which adds nothing.
    if (axes_.empty()) axes_.emplace_back(0, 2, laws.axis(0, 2), rest_(2, 0));
    rows_.resize(axes_.size(), linear_.mass.rows());
    for (std::size_t a = 0; a < axes_.size(); ++a)
        rows_.row(a) = linear_.ends[axes_[a].connection()].row(axes_[a].axis());
}

Eigen::VectorXd PeriodicSystem::calcForce(double frequency) const {
    Eigen::Vector3d load = input_.load;
    if (model_.load) load = calcLoadGains(*model_.load, frequency).cwiseProduct(load);
    return linear_.load * load + linear_.base * input_.base;
}

}  // namespace wems
