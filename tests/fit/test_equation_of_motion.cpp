// The body's part of the equations of motion against Newton and Euler: rates of momentum and angular momentum by
// differences along a motion in closed form.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "identify/fit/equation_of_motion.hpp"
#include "tests/motion/analytic_motion.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kInterval = 1e-3;
constexpr int kSamples = 400;

MountModel makeModel() {
    MountModel model = test::makeCrossModel();
    model.body.mass = 8;
    model.body.center_of_gravity = {0.02, -0.01, 0.03};
    model.body.inertia << 0.12, 0.01, -0.02, 0.01, 0.15, 0.005, -0.02, 0.005, 0.05;
    model.body.spin = {0.3, -0.1, 0.5};
    model.gravity = {0, 3, -9};
    return model;
}

RunMotion makeRun(const test::AnalyticMotion& motion, bool accelerations) {
    RunMotion run;
    run.interval = kInterval;
    PartMotion& part = run.mobile;
    part.displacement_measured = true;
    part.acceleration_measured = accelerations;
    for (Eigen::Matrix3Xd* signal : {&part.p, &part.theta, &part.v, &part.w, &part.a, &part.alpha})
        signal->setZero(3, kSamples);
    run.fixed = part;
    for (int k = 0; k < kSamples; ++k) {
        const double t = k * kInterval;
        run.time.push_back(t);
        const Eigen::AngleAxisd turn(motion.R(t));
        part.p.col(k) = motion.p(t);
        part.theta.col(k) = turn.angle() * turn.axis();
        part.v.col(k) = motion.v(t);
        part.w.col(k) = motion.w(t);
        part.a.col(k) = motion.a(t);
        part.alpha.col(k) = motion.alpha(t);
    }
    return run;
}

/// Force and moment about Mo that the motion takes.
Vector6d calcWrench(const test::AnalyticMotion& motion, const MountModel& model, double t) {
    const MobileBody& body = model.body;
    const Eigen::Vector3d& c = body.center_of_gravity;
    const Eigen::Matrix3d about_origin =
        body.inertia + body.mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
    const auto momentum = [&](double s) {
        const Eigen::Matrix3d R = motion.R(s);
        Vector6d result;
        result << body.mass * (motion.v(s) + motion.w(s).cross(R * c)),
            R * (about_origin * (R.transpose() * motion.w(s)) + body.spin);
        return result;
    };
    const double h = 2e-5;
    Vector6d wrench =
        (8 * (momentum(t + h) - momentum(t - h)) - (momentum(t + 2 * h) - momentum(t - 2 * h))) / (12 * h);
    wrench.head<3>() -= body.mass * model.gravity;
    wrench.tail<3>() += body.mass * (motion.R(t) * c).cross(motion.a(t) - model.gravity);
    return wrench;
}

}  // namespace

TEST_CASE("the body's columns are Newton and Euler's equations, from accelerations and from displacements alone") {
    const unsigned seed = test::drawSeed();
    const bool accelerations = GENERATE(true, false);
    CAPTURE(seed, accelerations);
    std::mt19937 random(seed);
    // Angles up to 0.17 rad: what the rate's series leaves out is below θ⁴/720 = 1.2e-6 of it, its last term is 2.4e-3.
    const test::AnalyticMotion motion(random, 2e-3, 0.1, 2, 8);
    const MountModel model = makeModel();
    const TestFunction phi(4, kInterval);
    const RunEquations equations = makeEquations(makeRun(motion, accelerations), model, phi, true);
    Eigen::VectorXd coefficients = makeCoefficients(equations.layout, model);
    coefficients.tail(2 * equations.layout.axes).setZero();  // the mount's part is left out
    const Eigen::VectorXd found = equations.columns * coefficients;

    Eigen::Matrix<double, 6, Eigen::Dynamic> expected(6, equations.outputs);
    expected.setZero();
    for (int n = 0; n < equations.outputs; ++n)
        for (int i = 0; i <= 2 * phi.half(); ++i)
            expected.col(n) += phi.value()[i] * calcWrench(motion, model, (n * phi.stride() + i) * kInterval);
    expected.colwise() -= expected.rowwise().mean().eval();
    for (int e = 0; e < 6; ++e) {
        double worst = 0;
        for (int n = 0; n < equations.outputs; ++n)
            worst = std::max(worst, std::abs(found(6 * n + e) - expected(e, n)));
        CAPTURE(e);
        CHECK(worst < 1e-5 * expected.cwiseAbs().maxCoeff());
    }
}
