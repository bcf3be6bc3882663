#include "identify/problem/mount_equation.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "identify/problem/band_limited_force.hpp"
#include "models/bryant.hpp"
#include "models/law_equality.hpp"
#include "models/mount_forces.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {

Eigen::MatrixXd calcLoad(const OpenLoopRun& run, const MountModel& model) {
    Eigen::MatrixXd load = run.load;
    if (!model.load) return load;
    for (Eigen::Index k = 0; k < load.cols(); ++k)
        load.col(k).array() *=
            calcLoadGains(*model.load, k < run.swept.size() ? run.swept[k] : std::numeric_limits<double>::quiet_NaN())
                .array();
    return load;
}

bool loadsMobilePart(const OpenLoopRun& run, const MountModel& model) {
    return model.load_point && model.load_point->part == Part::mobile && run.load.cols() > 0;
}

Eigen::MatrixXd calcLoadWrench(const OpenLoopRun& run, const LoadPoint& point,
                               const Eigen::Ref<const Eigen::MatrixXd>& load) {
    const auto& R = point.part == Part::mobile ? run.mobile.R : run.fixed.R;
    Eigen::MatrixXd wrench(6, load.cols());
    for (Eigen::Index k = 0; k < load.cols(); ++k) {
        const Eigen::Vector3d force = load.col(k);
        wrench.col(k) << force, (R[k] * point.position).cross(force);
    }
    return wrench;
}

Eigen::Matrix<double, 6, 3> calcLoadArm(const LoadPoint& point) {
    Eigen::Matrix<double, 6, 3> arm;
    arm << Eigen::Matrix3d::Identity(), crossMatrix(point.position);
    return arm;
}

namespace {

/// z(h) of z' = (q − z)/τ over a step: decay · z(0) + weights · (q0, h v0, q1, h v1) for cubic Hermite q.
struct BranchStep {
    double decay;
    double weight[4];
};

/// Moments ∫ x e^(−x (1 − u)) uⁿ du over the step, n = 0 … 3.
std::array<double, 4> calcMoments(double x) {
    std::array<double, 4> moments{};
    constexpr double kShort = 2;  // below, the differences of the recurrence cancel: 3! / x³ of the rounding
    if (x > kShort) {
        moments[0] = -std::expm1(-x);
        for (std::size_t n = 1; n < moments.size(); ++n) moments[n] = 1 - static_cast<double>(n) / x * moments[n - 1];
        return moments;
    }
    // Gauss–Legendre on four pieces, each at most half a time constant.
    constexpr double kNode[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    constexpr double kWeight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    constexpr int kPieces = 4;
    for (int i = 0; i < kPieces; ++i)
        for (int g = 0; g < 3; ++g) {
            const double u = (i + 0.5 + 0.5 * kNode[g]) / kPieces;  // 0 … 1 within the step
            double factor = 0.5 * kWeight[g] / kPieces * x * std::exp(-x * (1 - u));
            for (double& moment : moments) {
                moment += factor;
                factor *= u;
            }
        }
    return moments;
}

BranchStep makeBranchStep(double interval, double time_constant) {
    const double x = interval / time_constant;
    const std::array<double, 4> m = calcMoments(x);
    return {std::exp(-x), {2 * m[3] - 3 * m[2] + m[0], m[3] - 2 * m[2] + m[1], 3 * m[2] - 2 * m[3], m[3] - m[2]}};
}

Eigen::Vector3d axisDirection(const OpenLoopRun& run, std::size_t sample, int axis) {
    return run.fixed.R[sample].col(axis);
}

}  // namespace

Eigen::VectorXd calcAxisForce(const OpenLoopRun& run, const AxisLaw& law, int connection, int axis) {
    const bool sliding = law.friction && !law.friction->presliding_stiffness;
    AxisLaw smooth = law;
    if (sliding) smooth.friction.reset();
    smooth.stops.clear();
    const AxisForce force(smooth);
    const int row = 3 * connection + axis;
    const Eigen::VectorXd q = run.q.row(row).transpose(), v = run.v.row(row).transpose();
    const int count = run.sampleCount();
    Eigen::VectorXd result(count);
    const auto& branches = force.branches();
    std::vector<double> z(force.stateCount(), 0.0);
    std::vector<BranchStep> steps;
    for (std::size_t b = 0; b < branches.size(); ++b) {
        steps.push_back(makeBranchStep(run.interval, branches[b].time_constant));
        z[b] = q[0];
    }
    for (int k = 0; k < count; ++k) {
        if (k > 0) {
            for (std::size_t b = 0; b < branches.size(); ++b) {
                const auto& s = steps[b];
                z[b] = s.decay * z[b] + s.weight[0] * q[k - 1] + s.weight[1] * run.interval * v[k - 1] +
                       s.weight[2] * q[k] + s.weight[3] * run.interval * v[k];
            }
            dragAlong(force, {q[k - 1], v[k - 1], q[k], v[k], run.interval}, z.data());
        }
        result[k] = force.calcForce(q[k], v[k], run.time[k], z.data());
    }
    result += calcStopForce(law, q, v, run.interval);
    if (sliding)
        result += law.friction->force * calcSlidingDirection(run.quiet.of(row), law.friction->transition_velocity);
    return result;
}

void addAxisWrench(const OpenLoopRun& run, const MountModel& model, int connection, int axis,
                   const Eigen::Ref<const Eigen::VectorXd>& f, Eigen::MatrixXd& wrench) {
    const Eigen::Vector3d position = model.connections[connection].position;
    for (int k = 0; k < run.sampleCount(); ++k) {
        const std::size_t s = k;
        const Eigen::Vector3d force = f[k] * axisDirection(run, s, axis);
        wrench.block<3, 1>(0, k) += force;
        wrench.block<3, 1>(3, k) += (run.mobile.R[s] * position).cross(force);
    }
}

Vector6 calcDemand(const MobileBody& body, const Eigen::Vector3d& gravity, const Eigen::Matrix3d& R,
                   const Eigen::Vector3d& w, const Eigen::Vector3d& a, const Eigen::Vector3d& alpha) {
    const Eigen::Vector3d c = R * body.center_of_gravity;
    const Eigen::Vector3d force = body.mass * (a + alpha.cross(c) + w.cross(w.cross(c)) - gravity);
    const Eigen::Matrix3d inertia = R * body.inertia * R.transpose();
    Vector6 demand;
    demand << force, inertia * alpha + w.cross(inertia * w + R * body.spin) + c.cross(force);
    return demand;
}

Eigen::MatrixXd calcDemand(const OpenLoopRun& run, const MobileBody& body, const Eigen::Vector3d& gravity) {
    Eigen::MatrixXd demand(6, run.sampleCount());
    const SmoothPart& part = run.mobile;
    for (Eigen::Index k = 0; k < demand.cols(); ++k)
        demand.col(k) = calcDemand(body, gravity, part.R[k], part.w.col(k), part.a.col(k), part.alpha.col(k));
    return demand;
}

Eigen::MatrixXd calcMountResidual(const OpenLoopRun& run, const MountModel& model) {
    Eigen::MatrixXd wrench = calcDemand(run, model.body, model.gravity);
    if (loadsMobilePart(run, model)) wrench -= calcLoadWrench(run, *model.load_point, calcLoad(run, model));
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const auto c = static_cast<int>(i);
            const auto& law = model.connections[i].axis[a];
            addAxisWrench(run, model, c, a, calcAxisForce(run, law, c, a), wrench);
        }
    return wrench;
}

}  // namespace wems::identify
