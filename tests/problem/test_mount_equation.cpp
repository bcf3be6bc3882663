#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/problem/mount_equation.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/slow_balance.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kInterval = 2e-3;

/// Of both parts at rest but for what the tests set.
OpenLoopRun makeRun(int samples, int connections) {
    OpenLoopRun run;
    run.interval = run.raw_interval = kInterval;
    run.time = Eigen::VectorXd::LinSpaced(samples, 0, (samples - 1) * kInterval);
    run.q = run.v = Eigen::MatrixXd::Zero(3 * connections, samples);
    run.quiet = QuietVelocities(run.v);
    for (SmoothPart* part : {&run.mobile, &run.fixed}) {
        part->p = part->theta = part->v = part->w = part->a = part->alpha = Eigen::Matrix3Xd::Zero(3, samples);
        part->R.assign(samples, Eigen::Matrix3d::Identity());
    }
    run.taper = Eigen::VectorXd::Ones(samples);
    return run;
}

MountModel makeModel() {
    MountModel model;
    model.body.mass = 8;
    model.body.center_of_gravity = {0.01, -0.02, 0.1};
    model.body.inertia = Eigen::Vector3d(0.12, 0.1, 0.03).asDiagonal();
    const Eigen::Vector3d places[] = {{-0.1, 0, 0}, {0.1, 0.02, 0}, {0, -0.1, 0.03}, {0, 0.1, 0}};
    for (const Eigen::Vector3d& place : places) {
        Connection connection;
        connection.name = std::to_string(model.connections.size() + 1);
        connection.position = place;
        for (AxisLaw& law : connection.axis)
            law.stiffness = 2.6e4 + 1e4 * static_cast<double>(model.connections.size());
        model.connections.push_back(connection);
    }
    return model;
}

}  // namespace

// τ z' = q − z along q = Σ c_n tⁿ up to the third degree, which cubic Hermite pieces follow exactly:
// z = q − τ q' + τ² q'' − τ³ q''' + C exp(−t/τ), z(0) = q(0).
TEST_CASE("A relaxing law along a cubic motion has the force of the closed solution") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    // Fast ones, both sides of where the moments of a step are found otherwise (half an interval), slow ones.
    for (const double part : {1e-6, 0.01, 0.3, 0.4999, 0.5001, 4.0, 100.0}) {
        const double time_constant = part * kInterval;
        constexpr int samples = 60;
        OpenLoopRun run = makeRun(samples, 1);
        const double c[4] = {1e-3 * draw(random), 0.02 * draw(random), 0.3 * draw(random), 2 * draw(random)};
        AxisLaw law;
        law.stiffness = 1e5;
        law.relaxation = Relaxation{0.4, time_constant};
        const auto along = [&](double t) {
            const double q = c[0] + t * (c[1] + t * (c[2] + t * c[3])), q1 = c[1] + t * (2 * c[2] + 3 * t * c[3]);
            const double q2 = 2 * c[2] + 6 * t * c[3], q3 = 6 * c[3];
            return q - time_constant * (q1 - time_constant * (q2 - time_constant * q3));
        };
        Eigen::VectorXd expected(samples);
        for (int k = 0; k < samples; ++k) {
            const double t = run.time[k];
            run.q(2, k) = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
            run.v(2, k) = c[1] + t * (2 * c[2] + 3 * t * c[3]);
            const double z = along(t) + (c[0] - along(0)) * std::exp(-t / time_constant);
            expected[k] = 1e5 * run.q(2, k) + 0.4e5 * (run.q(2, k) - z);
        }
        CAPTURE(time_constant);
        // In closed form up to half an interval: a millionth of what the branch adds, k_b (q − z). Beyond, three Gauss
        // points on steps h of half a time constant or less find z itself, to h⁶ (3!)⁴ / (7 (6!)³) = 8e-9 of the
        // largest e⁻ˢ in a step, which is 1.27 times its mean.
        const double branch = (expected - 1e5 * run.q.row(2).transpose()).cwiseAbs().maxCoeff();
        const double most = part < 0.5 ? 1e-6 * branch : 1e-8 * 0.4e5 * run.q.row(2).cwiseAbs().maxCoeff();
        CHECK((calcAxisForce(run, law, 0, 2) - expected).cwiseAbs().maxCoeff() < most);
    }
}

// The slow motion x that a residual R = −(M ẍ + K x) asks for, in the middle of a run: (ω² M − K)⁻¹ of its amplitude
// at a frequency far below the knots' own; of the fixed part, the other way, without M.
TEST_CASE("The slow motion that balances a slow force is that of the linear mount") {
    const MountModel model = makeModel();
    constexpr int samples = 2000;  // 4 s
    OpenLoopRun run = makeRun(samples, 4);
    run.lowest = 4;  // Hz: splines up to 5 Hz
    run.mobile_integrated = GENERATE(true, false);
    run.fixed_integrated = !run.mobile_integrated;
    for (int k = 0; k < 200; ++k) run.taper[k] = run.taper[samples - 1 - k] = 0.5 - 0.5 * std::cos(kPi * k / 200.0);
    const SlowBalance balance(run, model);
    CHECK(balance.cornerFrequency() == Approx(5));
    const double w = kTwoPi * 1.0;
    Eigen::Matrix<double, 6, 1> amplitude;
    amplitude << 3, -2, 5, 0.1, 0.2, -0.05;
    const Eigen::RowVectorXd wave = (w * run.time.array()).sin().matrix().transpose();
    const Eigen::MatrixXd residual = amplitude * wave;
    const Eigen::VectorXd coefficients = balance.solve(residual);
    const Eigen::Matrix<double, 6, 6> K = calcStiffnessMatrix(model);
    Eigen::Matrix<double, 6, 6> M = calcMassMatrix(model.body);
    if (run.fixed_integrated) M.setZero();
    const Eigen::Matrix<double, 6, 1> expected = (K - w * w * M).partialPivLu().solve(amplitude);
    const Eigen::MatrixXd x = balance.calcMotion(coefficients, 0), a = balance.calcMotion(coefficients, 2);
    for (int k = samples / 4; k < 3 * samples / 4; k += 37) {
        CAPTURE(k);
        // Splines of 20 knots a period err by (π/10)⁴/720 or so.
        CHECK((x.col(k) - expected * wave[k]).norm() < 1e-3 * expected.norm());
        CHECK((a.col(k) + w * w * expected * wave[k]).norm() < 0.03 * w * w * expected.norm());
    }
}

// Contact at a few samples: the tangent stiffness of each sample, summed over the axes one by one, times the slow
// motion.
TEST_CASE("The forces of a slow motion have the stops' stiffness where they touch") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    MountModel model = makeModel();
    model.connections[1].axis[2].stops = {{Side::positive, 1e-3, 1e6, 0}, {Side::negative, 1e-3, 5e5, 0}};
    model.connections[3].axis[0].stops = {{Side::positive, 1e-3, 3e5, 0}, {Side::negative, 1e-3, 3e5, 0}};
    constexpr int samples = 6000;
    OpenLoopRun run = makeRun(samples, 4);
    run.lowest = 4;
    run.fixed_integrated = true;  // no inertia
    for (int k = 0; k < samples; ++k) {
        run.q(5, k) = 1.2e-3 * std::sin(kTwoPi * 7 * run.time[k]);
        run.q(9, k) = 1.1e-3 * std::cos(kTwoPi * 9 * run.time[k]);
    }
    const SlowBalance balance(run, model);
    const Eigen::VectorXd c = balance.solve(Eigen::MatrixXd::NullaryExpr(6, samples, [&] { return normal(random); }));
    const Eigen::MatrixXd moved = balance.calcMotion(c, 0), forces = balance.calcForces(c);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6, samples);
    bool touched = false;
    for (Eigen::Index row = 0; row < run.q.rows(); ++row) {
        const auto connection = static_cast<int>(row / 3), axis = static_cast<int>(row % 3);
        const Vector6 d = calcAxisDirection(model, connection, axis);
        const AxisLaw& law =
            model.connections[static_cast<std::size_t>(connection)].axis[static_cast<std::size_t>(axis)];
        const Eigen::VectorXd tangent = calcTangent(run, law, row);
        touched = touched || tangent.maxCoeff() > 1.5 * law.stiffness;
        for (int k = 0; k < samples; ++k) expected.col(k) += tangent[k] * d * d.dot(moved.col(k));
    }
    CHECK(touched);
    CHECK((forces - expected).norm() < 1e-12 * expected.norm());
    // Of forces that a slow motion makes nothing is left, but for what holds the splines at both ends: that falls by
    // half from one knot to the next, and there are 60 to the middle.
    CHECK(balance.balance(forces).middleCols(2900, 200).norm() < 1e-9 * forces.norm());
}

// A run that ends while it moves: the spline that touches it with its last samples alone took hundreds of times the
// motion, and all others stalled. Newton's steps end where the next one is nothing.
TEST_CASE("The slow motion of a run that ends in motion settles, wherever the last spline begins") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    MountModel model = makeModel();
    model.gravity.setZero();
    for (int trial = 0; trial < 10; ++trial) {
        const int samples = std::uniform_int_distribution<int>(1900, 2100)(random);
        CAPTURE(samples);
        OpenLoopRun run = makeRun(samples, 4);
        run.lowest = 4;
        run.mobile_integrated = true;
        for (int k = 0; k < 100; ++k) run.taper[k] = run.taper[samples - 1 - k] = 0.5 - 0.5 * std::cos(kPi * k / 100.0);
        const double w = kTwoPi * 7, phase = std::uniform_real_distribution<double>(0, kTwoPi)(random);
        const Eigen::Vector3d amplitude(4e-4, -3e-4, 5e-4);  // m
        run.mobile.p = amplitude * (w * run.time.array() + phase).sin().matrix().transpose();
        run.mobile.v = w * amplitude * (w * run.time.array() + phase).cos().matrix().transpose();
        run.mobile.a = -w * w * run.mobile.p;
        calcRelative(model, run.mobile, run.fixed, run.q, run.v);
        const auto balance = followSlowMotion(run, model);
        REQUIRE(balance);
        const auto size = [&](const Eigen::VectorXd& coefficients) {
            const Eigen::MatrixXd motion = balance->calcMotion(coefficients, 0);
            return std::sqrt(motion.colwise().squaredNorm().dot(run.taper) / run.taper.sum());
        };
        CHECK(size(balance->solveHeld(calcMountResidual(run, model), balance->followed())) < 1e-3 * amplitude.norm());
        CHECK(size(balance->followed()) < amplitude.norm());
    }
}

// A mobile part held in a motion of 1 Hz needs the forces of the mount; that fixed part which gives them follows by
// x_F = x_M − K⁻¹ (ω² M) x_M.
TEST_CASE("A fixed part whose slow motion was not measured takes it, and the measured mobile part none") {
    MountModel model = makeModel();
    model.gravity.setZero();
    constexpr int samples = 2000;  // 4 s
    OpenLoopRun run = makeRun(samples, 4);
    run.lowest = 4;
    run.fixed_integrated = true;
    for (int k = 0; k < 200; ++k) run.taper[k] = run.taper[samples - 1 - k] = 0.5 - 0.5 * std::cos(kPi * k / 200.0);
    const double w = kTwoPi * 1.0;
    const Eigen::Vector3d held(4e-5, -3e-5, 5e-5);  // m
    const Eigen::RowVectorXd wave = (w * run.time.array()).sin().matrix().transpose();
    run.mobile.p = held * wave;
    run.mobile.v = held * (w * (w * run.time.array()).cos()).matrix().transpose();
    run.mobile.a = -w * w * run.mobile.p;
    calcRelative(model, run.mobile, run.fixed, run.q, run.v);
    const OpenLoopRun measured = run;
    followSlowMotion(run, model);
    CHECK(run.mobile.p == measured.mobile.p);
    CHECK(run.mobile.a == measured.mobile.a);
    Eigen::Matrix<double, 6, 1> pose;
    pose << held, Eigen::Vector3d::Zero();
    const Eigen::Matrix<double, 6, 1> expected =
        pose - calcStiffnessMatrix(model).partialPivLu().solve(w * w * calcMassMatrix(model.body) * pose);
    for (int k = samples / 4; k < 3 * samples / 4; k += 37) {
        CAPTURE(k);
        CHECK((run.fixed.p.col(k) - expected.head<3>() * wave[k]).norm() < 1e-3 * expected.head<3>().norm());
        CHECK((run.fixed.theta.col(k) - expected.tail<3>() * wave[k]).norm() < 1e-3 * expected.head<3>().norm());
    }
}
