#include "identify/forward/initial_state.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/forward/relative_displacement.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

constexpr double noise_limit = 6;      // standard deviations
constexpr double motion_limit = 2e-3;  // of the largest displacement from the median
constexpr int degree = 4;              // of the polynomial
constexpr Eigen::Index kLeastSamples = 8, kMostSamples = 64;

/// Value and slope at the first sample, each 3-vectors.
struct Start {
    Eigen::Vector3d value, slope;
};

Start fitStart(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& a, bool with_acceleration, double h,
               Eigen::Index count) {
    const Eigen::Index columns = with_acceleration ? 2 : degree + 1;
    Eigen::MatrixXd design(count, columns);
    Eigen::MatrixXd right = x.leftCols(count).transpose();
    Eigen::RowVector3d velocity = Eigen::RowVector3d::Zero(), displacement = velocity;
    for (Eigen::Index k = 0; k < count; ++k) {
        for (Eigen::Index j = 0; j < columns; ++j)
            design(k, j) = std::pow(static_cast<double>(k), static_cast<double>(j));
        if (!with_acceleration) continue;
        if (k > 0) {  // a linear between samples
            const Eigen::RowVector3d before = a.col(k - 1).transpose(), now = a.col(k).transpose();
            displacement += h * velocity + h * h * (2 * before + now) / 6;
            velocity += h * (before + now) / 2;
        }
        right.row(k) -= displacement;
    }
    const Eigen::MatrixXd solution = design.householderQr().solve(right);
    return {solution.row(0).transpose(), solution.row(1).transpose() / h};
}

/// Position and velocity of a part's frame at the first sample.
FrameMotion fitFrame(const PartMotion& part, double h, Eigen::Index count) {
    FrameMotion motion;
    const Start translation = fitStart(part.p, part.a, part.acceleration_measured, h, count);
    const Start rotation = fitStart(part.theta, part.alpha, part.acceleration_measured, h, count);
    motion.p_GF = translation.value;
    motion.v_GF = translation.slope;
    motion.R_GF = rotationFromVector(rotation.value);
    motion.w_GF = leftJacobian(rotation.value) * rotation.slope;
    return motion;
}

/// At the first sample itself: a sweep that begins hard moves within a few samples, from rest.
bool startsMoving(const RunMotion& run, const MountModel& model, Eigen::Index count) {
    const Eigen::MatrixXd q = calcRelativeDisplacement(run, model).q;
    const double noise = std::hypot(std::isfinite(run.mobile.displacement_noise) ? run.mobile.displacement_noise : 0.0,
                                    std::isfinite(run.fixed.displacement_noise) ? run.fixed.displacement_noise : 0.0);
    // Value, and slope times the length of the fit, of each row at the first sample.
    Eigen::MatrixXd design(count, degree + 1);
    for (Eigen::Index k = 0; k < count; ++k)
        for (Eigen::Index j = 0; j <= degree; ++j)
            design(k, j) = std::pow(static_cast<double>(k) / static_cast<double>(count), static_cast<double>(j));
    const Eigen::MatrixXd weights = design.completeOrthogonalDecomposition().pseudoInverse().topRows(2);
    const Eigen::Vector2d deviation = noise * weights.rowwise().norm();
    double largest = 0;
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
        Eigen::VectorXd values = q.row(i);
        std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
        const Eigen::VectorXd from_rest = q.row(i).transpose().array() - values[values.size() / 2];
        largest = std::max(largest, from_rest.cwiseAbs().maxCoeff());
        first = first.cwiseMax((weights * from_rest.head(count)).cwiseAbs());
    }
    return (first.array() > (noise_limit * deviation.array()).max(motion_limit * largest)).any();
}

}  // namespace

std::optional<StartMotion> findStartMotion(const RunMotion& run, const MountModel& model, const Drive& drive) {
    const bool fixed_known = run.fixed_source != FixedSource::channels || run.fixed.displacement_measured;
    if (!run.mobile.displacement_measured || !fixed_known || drive.base().cols() > 0) return std::nullopt;
    const auto samples = static_cast<Eigen::Index>(run.time.size());
    const auto half_period = static_cast<Eigen::Index>(0.5 / (run.trusted_to * run.interval));
    const Eigen::Index count = std::clamp(half_period, kLeastSamples, kMostSamples);
    if (samples < count || !startsMoving(run, model, count)) return std::nullopt;
    StartMotion start;
    const FrameMotion mobile = fitFrame(run.mobile, run.interval, count);
    start.mobile = {mobile.R_GF, mobile.p_GF, mobile.w_GF, mobile.v_GF};
    start.fixed = fitFrame(run.fixed, run.interval, count);
    return start;
}

ForwardState makeState(const ForwardModel& forward, const StartMotion& start, const Drive& drive) {
    ForwardState state = forward.restState();
    state.mobile = start.mobile;
    const std::vector<BracketMode>& modes = forward.model().bracket;
    if (drive.prescribesMotion() || modes.empty()) return state;
    const Eigen::Index count = modes.size();
    Eigen::MatrixXd shape(6, count);
    Eigen::VectorXd omega(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const BracketMode& mode = modes[j];
        shape.col(j) << mode.translation, mode.rotation;
        omega[j] = kTwoPi * mode.frequency;
    }
    const Eigen::Vector3d theta = vectorFromRotation(start.fixed.R_GF);
    Eigen::VectorXd pose(6), velocity(6);
    pose << start.fixed.p_GF, theta;
    velocity << start.fixed.v_GF, leftJacobian(theta).inverse() * start.fixed.w_GF;
    const auto solve = [](const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
        solver.setThreshold(1e-6);  // directions that the modes hardly move in are not told from noise
        return Eigen::VectorXd(solver.compute(matrix).solve(right));
    };
    // From the static deflection, which the modes have in common.
    Eigen::VectorXd rest(6);
    rest = shape * state.eta;
    state.eta += omega.cwiseInverse().asDiagonal() * solve(shape * omega.cwiseInverse().asDiagonal(), pose - rest);
    state.eta_dot = solve(shape, velocity);
    return state;
}

ForwardState makeInitialState(const ForwardModel& forward, const std::optional<StartMotion>& start,
                              const Drive& drive) {
    return start ? makeState(forward, *start, drive) : forward.restState(drive);
}

}  // namespace wems::identify
