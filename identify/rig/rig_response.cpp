#include "identify/rig/rig_response.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/forward/forward_model.hpp"

namespace wems::identify {
namespace {

// Step times the highest natural frequency, and times the highest damping rate: half of what the forward model takes.
constexpr double kFrequencyStep = 0.4, kDampingStep = 1;
constexpr double kMostRigSteps = 1000;  // for each sample

/// Slopes for each sample interval, of fourth order inside, one-sided at the ends.
Eigen::VectorXd calcSlopes(const Eigen::VectorXd& f) {
    const Eigen::Index n = f.size();
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        if (k >= 2 && k + 2 < n)
            slope[k] = (8 * (f[k + 1] - f[k - 1]) - (f[k + 2] - f[k - 2])) / 12;
        else if (k >= 1 && k + 1 < n)
            slope[k] = 0.5 * (f[k + 1] - f[k - 1]);
        else if (n > 1)
            slope[k] = k == 0 ? f[1] - f[0] : f[n - 1] - f[n - 2];
    }
    return slope;
}

/// A sampled force between its samples.
class Input {
public:
    explicit Input(Eigen::VectorXd values) : values_(std::move(values)), slopes_(calcSlopes(values_)) {}
    /// @param s from sample k to the next, 0 … 1
    double at(Eigen::Index k, double s) const {
        const double r = 1 - s;
        return (1 + 2 * s) * r * r * values_[k] + s * r * r * slopes_[k] + s * s * (3 - 2 * s) * values_[k + 1] -
               s * s * r * slopes_[k + 1];
    }

private:
    Eigen::VectorXd values_, slopes_;
};

class Rig {
public:
    Rig(const MountModel& model, int axis) : mass_(model.body.mass) {
        Eigen::VectorXd rest;
        if (!model.gravity.isZero(0.0)) rest = ForwardModel(model).restDisplacement();
        Eigen::Index row = axis;
        for (const Connection& connection : model.connections) {
            forces_.emplace_back(connection.axis[static_cast<std::size_t>(axis)]);
            rest_.push_back(rest.size() > 0 ? rest[row] : 0.0);
            row += 3;
            states_ += forces_.back().stateCount();
        }
        y_.assign(static_cast<std::size_t>(2 + states_), 0.0);
        // At rest the dashpots of branches are relaxed.
        std::size_t state = 2;
        for (std::size_t i = 0; i < forces_.size(); ++i) {
            for (std::size_t b = 0; b < forces_[i].branches().size(); ++b) y_[state + b] = rest_[i];
            held_ += forces_[i].calcForce(rest_[i], 0, 0, y_.data() + state);
            state += static_cast<std::size_t>(forces_[i].stateCount());
        }
    }

    int countSteps(double interval) const {
        double stiffness = 0, damping = 0;
        for (const AxisForce& force : forces_) {
            const AxisLaw& law = force.law();
            double positive = 0, negative = 0;
            for (const Stop& stop : law.stops)
                (stop.side == Side::positive ? positive : negative) += std::max(0.0, stop.stiffness);
            stiffness += law.stiffness + std::max(positive, negative) + force.draggedStiffness(true);
            for (const MaxwellBranch& branch : force.branches()) {
                stiffness += branch.stiffness;
                damping = std::max(damping, mass_ / branch.time_constant);
            }
            damping += law.damping;
            if (law.friction && !law.friction->presliding_stiffness)
                damping += law.friction->force / law.friction->transition_velocity;
        }
        const double rate = std::max(std::sqrt(stiffness / mass_) / kFrequencyStep, damping / mass_ / kDampingStep);
        return static_cast<int>(std::clamp(std::ceil(interval * rate), 1.0, kMostRigSteps));
    }

    void begin(double q, double v) {
        y_[0] = q;
        y_[1] = v;
    }
    double displacement() const { return y_[0]; }

    /// One step; the driving force at its start, middle and end, N.
    void step(double t, double h, const double (&drive)[3]) {
        calcRates(t, y_, drive[0], k_[0]);
        move(y_, k_[0], 0.5 * h);
        calcRates(t + 0.5 * h, moved_, drive[1], k_[1]);
        move(y_, k_[1], 0.5 * h);
        calcRates(t + 0.5 * h, moved_, drive[1], k_[2]);
        move(y_, k_[2], h);
        calcRates(t + h, moved_, drive[2], k_[3]);
        for (std::size_t i = 0; i < y_.size(); ++i) y_[i] += h / 6 * (k_[0][i] + 2 * (k_[1][i] + k_[2][i]) + k_[3][i]);
    }

private:
    void move(const std::vector<double>& from, const std::vector<double>& rate, double by) {
        moved_.resize(from.size());
        for (std::size_t i = 0; i < from.size(); ++i) moved_[i] = from[i] + by * rate[i];
    }

    void calcRates(double t, const std::vector<double>& y, double drive, std::vector<double>& rate) const {
        rate.resize(y.size());
        double force = -held_;
        std::size_t state = 2;
        for (std::size_t i = 0; i < forces_.size(); ++i) {
            const double q = rest_[i] + y[0];
            force += forces_[i].calcForce(q, y[1], t, y.data() + state);
            forces_[i].calcStateDerivative(q, y[1], y.data() + state, rate.data() + state);
            state += static_cast<std::size_t>(forces_[i].stateCount());
        }
        rate[0] = y[1];
        rate[1] = (drive - force) / mass_;
    }

    double mass_, held_ = 0;
    std::vector<AxisForce> forces_;
    std::vector<double> rest_;
    int states_ = 0;
    std::vector<double> y_, moved_, k_[4];
};

}  // namespace

Eigen::VectorXd simulateRig(const MountModel& model, int axis, const RigRun& run) {
    Rig rig(model, axis);
    Eigen::VectorXd total = Eigen::VectorXd::Zero(run.count);
    if (run.load.size() > 0) total += run.load;
    if (run.acceleration.size() > 0) total -= model.body.mass * run.acceleration;
    const Input input(std::move(total));
    const int steps = rig.countSteps(run.interval);
    const double h = run.interval / steps;
    rig.begin(run.start, run.start_velocity);
    Eigen::VectorXd q(run.count);
    for (Eigen::Index k = 0; k < run.count; ++k) {
        q[k] = rig.displacement();
        if (!std::isfinite(q[k])) {
            q.tail(run.count - k).setConstant(k > 0 ? q[k - 1] : 0.0);
            return q;
        }
        if (k + 1 == run.count) break;
        for (int i = 0; i < steps; ++i) {
            const double s = static_cast<double>(i) / steps, part = 1.0 / steps;
            rig.step(static_cast<double>(k) * run.interval + i * h, h,
                     {input.at(k, s), input.at(k, s + 0.5 * part), input.at(k, s + part)});
        }
    }
    return q;
}

}  // namespace wems::identify
