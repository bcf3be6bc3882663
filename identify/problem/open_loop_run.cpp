#include "identify/problem/open_loop_run.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/motion/parallel.hpp"
#include "identify/problem/band_limited_force.hpp"
#include "identify/problem/smoothing_kernel.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

namespace {

Matrix6 sumAxes(const MountModel& model, double AxisLaw::*coefficient) {
    Matrix6 sum = Matrix6::Zero();
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int a = 0; a < 3; ++a) {
            const Vector6 d = calcAxisDirection(model, static_cast<int>(i), a);
            sum += model.connections[i].axis[a].*coefficient * d * d.transpose();
        }
    return sum;
}

}  // namespace

Vector6 calcAxisDirection(const MountModel& model, int connection, int axis) {
    Vector6 d;
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(axis);
    d << e, model.connections[connection].position.cross(e);
    return d;
}

Matrix6 calcMassMatrix(const MobileBody& body) {
    const Eigen::Matrix3d C = crossMatrix(body.center_of_gravity);
    Matrix6 M;
    M << body.mass * Eigen::Matrix3d::Identity(), -body.mass * C, body.mass * C, body.inertia - body.mass * C * C;
    return M;
}

Vector6 calcFreedom(const MobileBody& body) {
    Vector6 freedom;
    for (std::size_t i = 0; i < body.free.size(); ++i) freedom[i] = body.free[i] ? 1 : 0;
    return freedom;
}

void holdMotions(Matrix6& matrix, const Vector6& freedom, double diagonal) {
    matrix = (freedom.asDiagonal() * matrix * freedom.asDiagonal()).eval();
    matrix.diagonal() += diagonal * (Vector6::Ones() - freedom);
}

Matrix6 calcStiffnessMatrix(const MountModel& model) {
    return sumAxes(model, &AxisLaw::stiffness);
}

double calcContactFrequency(const MountModel& model) {
    MountModel closed = model;
    bool any = false;
    for (Connection& connection : closed.connections)
        for (AxisLaw& law : connection.axis) {
            double stiffest = 0;
            for (const Stop& stop : law.stops) stiffest = std::max(stiffest, stop.stiffness);
            law.stiffness += stiffest;
            any = any || stiffest > 0;
        }
    if (!any) return 0;
    const Vector6 freedom = calcFreedom(model.body);
    Matrix6 mass = calcMassMatrix(model.body), stiffness = calcStiffnessMatrix(closed);
    holdMotions(mass, freedom, 1);
    holdMotions(stiffness, freedom, 0);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness, mass, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, modes.eigenvalues().maxCoeff())) / kTwoPi;
}

namespace {

// Ends of the window. A mode's response to tapered inputs is not its tapered response, by the slope of the window times
// the mode's memory: with ends of 0.15 s a mode at the end of a sweep moved damping ratios by ten standard deviations.
constexpr double kEnd = 0.05;            // of the recording, the longest
constexpr double kEndPower = 0.05;       // of the motion's power, where it comes in a burst
constexpr double kLeastPeriods = 0.75;   // of the lowest excited frequency, which the window must not mistake for slow
constexpr double kSmallestNoise = 1e-8;  // m: round-off of a file, where the noise is not known
constexpr double kSmallestAcceleration = 1e-5;  // m/s²
constexpr double kUnmeasured = 1.0;             // m: the accelerations alone count

SmoothPart smooth(const PartMotion& part, const RunFilter& filter) {
    SmoothPart result;
    result.p = filter.apply(part.p, 0);
    result.v = filter.apply(part.p, 1);
    result.a = filter.apply(part.p, 2);
    result.theta = filter.apply(part.theta, 0);
    const Eigen::MatrixXd rate = filter.apply(part.theta, 1), rate2 = filter.apply(part.theta, 2);
    const Eigen::Index count = result.p.cols();
    result.w.resize(3, count);
    result.alpha.resize(3, count);
    result.R.resize(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        const Eigen::Vector3d theta = result.theta.col(k), u = rate.col(k), u2 = rate2.col(k);
        const Eigen::Matrix3d B = leftJacobian(theta);
        result.R[k] = rotationFromVector(theta);
        result.w.col(k) = B * u;
        // d/dt B(θ) to second order in θ: B = 1 + [θ]×/2 + [θ]×²/6.
        const Eigen::Matrix3d T = crossMatrix(theta), U = crossMatrix(u);
        result.alpha.col(k) = B * u2 + (0.5 * U + (T * U + U * T) / 6.0) * u;
    }
    return result;
}

/// A noise that is not known, as that of a single channel, is that of round-off.
double knownNoise(double measured, double smallest = kSmallestNoise) {
    return std::isfinite(measured) && measured > smallest ? measured : smallest;
}

/// Noise density of a part's displacement along `direction` at angular frequency w, m²/Hz, one-sided.
double calcDensity(const PartMotion& part, const Eigen::Matrix<double, 6, 1>& direction, double interval, double w) {
    const double displacement = knownNoise(part.displacement_noise),
                 acceleration = knownNoise(part.acceleration_noise, kSmallestAcceleration);
    const double by_displacement =
        displacement * displacement * direction.dot(part.displacement_covariance * direction);
    const double by_acceleration =
        acceleration * acceleration / std::pow(w, 4) * direction.dot(part.acceleration_covariance * direction);
    if (!part.acceleration_measured) return part.displacement_measured ? 2 * interval * by_displacement : 0.0;
    if (!part.displacement_measured) return 2 * interval * by_acceleration;
    return 2 * interval / (1 / by_displacement + 1 / by_acceleration);
}

/// Of each relative velocity, as removeVelocityNoise takes it.
Eigen::MatrixXd calcVelocityDensity(const RunMotion& run, const MountModel& model, const ExcitedBand& band,
                                    double interval, double lowest) {
    const int frame = velocityNoiseFrame(interval, band.lowest);
    Eigen::MatrixXd density(3 * model.connections.size(), frame / 2 + 1);
    for (Eigen::Index row = 0; row < density.rows(); ++row) {
        const auto direction = calcAxisDirection(model, static_cast<int>(row / 3), static_cast<int>(row % 3));
        for (Eigen::Index b = 0; b < density.cols(); ++b) {
            const double w =
                kTwoPi * std::max(static_cast<double>(b) / (frame * interval), std::max(lowest, 0.1 * band.lowest));
            density(row, b) = w * w *
                              (calcDensity(run.mobile, direction, run.interval, w) +
                               calcDensity(run.fixed, direction, run.interval, w));
        }
    }
    return density;
}

/// Length of a window's rising end: as long as it may be without hiding a burst that the recording begins with.
/// @param power of the motion at each sample, from that end on
double calcEnd(const Eigen::Ref<const Eigen::VectorXd>& power, double interval, double edge, double lowest) {
    const double length = static_cast<double>(power.size() - 1) * interval;
    const double longest = kEnd * length, shortest = std::min(kLeastPeriods / lowest, longest);
    const double most = kEndPower * power.sum();
    double before = 0, end = shortest;
    for (Eigen::Index k = 0; k < power.size(); ++k) {
        before += power[k];
        end = static_cast<double>(k) * interval - edge;
        if (end >= longest || before > most) break;
    }
    return std::clamp(end, shortest, longest);
}

/// @param edge s, at both ends, where the smoothing lacks samples
Eigen::VectorXd makeWindow(const OpenLoopRun& run, double edge) {
    // Each axis counts alike.
    Eigen::MatrixXd q = run.q.colwise() - run.q.rowwise().mean();
    for (Eigen::Index row = 0; row < q.rows(); ++row) q.row(row) /= std::max(q.row(row).norm(), 1e-300);
    const Eigen::VectorXd power = q.colwise().squaredNorm().transpose();
    const double first = calcEnd(power, run.interval, edge, run.band.lowest),
                 last = calcEnd(power.reverse(), run.interval, edge, run.band.lowest);
    const Eigen::Index count = power.size();
    const double length = static_cast<double>(count - 1) * run.interval;
    Eigen::VectorXd window(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) * run.interval;
        const double u = std::min((t - edge) / first, (length - t - edge) / last);
        window[k] = 0.5 - 0.5 * std::cos(kPi * std::clamp(u, 0.0, 1.0));
    }
    return window;
}

}  // namespace

void calcRelative(const MountModel& model, const SmoothPart& mobile, const SmoothPart& fixed, AxisSeries& q,
                  AxisSeries& v) {
    const auto count = mobile.p.cols();
    const Eigen::Index connections = model.connections.size();
    q.resize(3 * connections, count);
    v.resize(3 * connections, count);
    for (Eigen::Index k = 0; k < count; ++k) {
        const std::size_t s = k;
        const BodyMotion body{mobile.R[s], mobile.p.col(k), mobile.w.col(k), mobile.v.col(k)};
        const FrameMotion frame{fixed.R[s], fixed.p.col(k), fixed.w.col(k), fixed.v.col(k)};
        for (Eigen::Index i = 0; i < connections; ++i) {
            const auto motion = calcRelativeMotion(body, frame, model.connections[i].position);
            q.block<3, 1>(3 * i, k) = motion.q;
            v.block<3, 1>(3 * i, k) = motion.v;
        }
    }
}

OpenLoopRun makeOpenLoopRun(const RunMotion& run, const MountModel& model, const ExcitedBand& band,
                            const Eigen::VectorXd& swept_frequency) {
    OpenLoopRun result;
    result.file = run.file;
    result.raw_interval = run.interval;
    result.band = band;
    const RunFilter filter(run.interval, band);
    result.filter = filter;
    result.pass = filter.pass();
    result.interval = filter.interval();
    runParallel(
        {[&] { result.mobile = smooth(run.mobile, filter); }, [&] { result.fixed = smooth(run.fixed, filter); }});
    calcRelative(model, result.mobile, result.fixed, result.q, result.v);
    result.quiet = QuietVelocities(result.v, velocityNoiseFrame(result.interval, band.lowest), result.interval,
                                   calcVelocityDensity(run, model, band, result.interval, run.trusted_from));
    if (run.load.cols() > 0) result.load = filter.apply(run.load, 0);
    if (run.base.cols() > 0) result.base = filter.apply(run.base, 0);
    const auto count = result.mobile.p.cols();
    result.time = Eigen::VectorXd::LinSpaced(count, 0.0, static_cast<double>(count - 1) * result.interval);
    if (swept_frequency.size() == run.mobile.p.cols()) {
        result.swept.resize(count);
        for (Eigen::Index k = 0; k < count; ++k) result.swept[k] = swept_frequency[filter.recorded(k)];
    }
    result.lowest = run.trusted_from;
    result.fixed_measured = run.fixed.displacement_measured || run.fixed.acceleration_measured;
    const auto displacementNoise = [](const PartMotion& part) {
        return part.acceleration_measured && !part.displacement_measured ? kUnmeasured
                                                                         : knownNoise(part.displacement_noise);
    };
    const auto isIntegrated = [](const PartMotion& part) {
        return part.acceleration_measured && !part.displacement_measured;
    };
    result.mobile_integrated = isIntegrated(run.mobile);
    result.fixed_integrated = isIntegrated(run.fixed);
    result.mobile_noise = displacementNoise(run.mobile);
    result.fixed_noise = result.fixed_measured ? displacementNoise(run.fixed) : 0.0;
    const auto accelerationNoise = [](const PartMotion& part) {
        if (!part.acceleration_measured) return std::numeric_limits<double>::infinity();
        return knownNoise(part.acceleration_noise, kSmallestAcceleration);
    };
    result.mobile_acceleration_noise = accelerationNoise(run.mobile);
    result.fixed_acceleration_noise = accelerationNoise(run.fixed);
    result.aliasing = calcAliasing(run);

    result.taper = makeWindow(result, filter.edge());
    return result;
}

std::complex<double> DynamicStiffness::at(double w) const {
    std::complex<double> sum(stiffness, w * damping);
    for (const MaxwellBranch& branch : branches)
        sum -= branch.stiffness / std::complex<double>(1, w * branch.time_constant);
    return sum;
}

DynamicStiffness calcDynamicStiffness(const OpenLoopRun& run, AxisLaw law, Eigen::Index row) {
    law.friction.reset();
    const Eigen::VectorXd stop = calcStopStiffness(law, run.q.row(row), run.v.row(row), run.interval);
    const AxisLaw whole = law;
    law.stops.clear();
    const AxisForce smooth(law), force(whole);
    const std::vector<double> z(static_cast<std::size_t>(smooth.stateCount()) + 1, 0.0);
    constexpr int kEvery = 4;  // samples; the mean of thousands needs no more where nothing jumps
    DynamicStiffness mean;
    double count = 0;
    for (int k = 0; k < run.sampleCount(); k += kEvery) {
        mean.stiffness += smooth.calcStiffness(run.q(row, k), run.v(row, k), run.time[k], z.data());
        mean.damping += smooth.calcDamping(run.q(row, k), run.v(row, k), run.time[k], z.data());
        ++count;
    }
    mean.stiffness = mean.stiffness / count + stop.mean();
    mean.damping /= count;
    double by_stops = 0;
    for (int k = 0; k < run.sampleCount(); ++k)
        if (stop[k] != 0)
            by_stops += force.calcDamping(run.q(row, k), run.v(row, k), run.time[k], z.data()) -
                        smooth.calcDamping(run.q(row, k), run.v(row, k), run.time[k], z.data());
    mean.damping += by_stops / run.sampleCount();
    mean.branches = smooth.branches();
    return mean;
}

Eigen::VectorXd calcTangent(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row) {
    Eigen::VectorXd stiffness = calcStopStiffness(law, run.q.row(row), run.v.row(row), run.interval);
    AxisLaw smooth = law;
    smooth.stops.clear();
    const AxisForce force(smooth);
    for (Eigen::Index k = 0; k < stiffness.size(); ++k) stiffness[k] += force.calcStaticStiffness(run.q(row, k));
    return stiffness;
}

Eigen::RowVectorXd calcStiffnessFluctuation(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row) {
    const Eigen::VectorXd stiffness = calcTangent(run, law, row);
    if ((stiffness.array() == stiffness[0]).all()) return Eigen::RowVectorXd::Zero(stiffness.size());
    return (stiffness.array() - stiffness.mean()).matrix().transpose();
}

}  // namespace wems::identify
