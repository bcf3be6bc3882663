// Small motions against closed forms and an independently assembled linear system.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <complex>
#include <unsupported/Eigen/MatrixFunctions>

#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

TEST_CASE("a damped oscillator follows its closed-form decay") {
    MountModel model = test::makeOscillator();
    model.connections[0].axis[2].damping = 8;
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(1e-3, 1001, 4);
    ForwardState initial = forward.restState();
    initial.mobile.p_GM.z() = 1e-3;
    const Simulation run = forward.simulate(Drive::makeFree(grid), initial, 0, grid.samples);
    const double omega = std::sqrt(2e4 / 2), zeta = 8 / (2 * std::sqrt(2e4 * 2));
    const double damped = omega * std::sqrt(1 - zeta * zeta);
    double worst = 0;
    for (int k = 0; k < grid.samples; ++k) {
        const double t = grid.sampleTime(k);
        const double exact =
            1e-3 * std::exp(-zeta * omega * t) * (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
        worst = std::max(worst, std::abs(run.q(2, k) - exact));
    }
    CHECK(worst < 1e-9);  // of an amplitude of 1e-3: phase error of the method (ω h)^5 / 120 a step
}

TEST_CASE("under a base acceleration the body lags behind as an oscillator under the opposite inertia force") {
    const ForwardModel forward(test::makeOscillator());
    const TimeGrid grid = test::makeGrid(1e-3, 501, 4);
    Eigen::Matrix3Xd base = Eigen::Matrix3Xd::Zero(3, grid.samples);
    base.row(2).setConstant(1.5);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), {}, base, grid);
    const Simulation run = forward.simulate(drive, Keep::states);
    const MarkerMotion markers = forward.calcMarkers(run, drive);
    for (int k : {0, 77, 500}) {
        const double cosine = std::cos(100 * grid.sampleTime(k));
        CHECK(run.q(2, k) == Approx(-1.5 / 1e4 * (1 - cosine)).margin(1e-10));
        CHECK(markers.mobile_acceleration(2, k) == Approx(1.5 * (1 - cosine)).margin(1e-6));
        CHECK(markers.fixed_acceleration(2, k) == Approx(1.5));
    }
}

TEST_CASE("a wheel makes the tilt precess as the gyroscopic pendulum does, in the right sense") {
    MountModel model = test::makeFreeBody();
    model.body.center_of_gravity.setZero();
    model.body.inertia = Eigen::Vector3d(0.1, 0.1, 0.05).asDiagonal();
    model.body.spin = {0, 0, 2.0};
    for (Connection& connection : model.connections) {
        connection.position.z() = 0;
        connection.axis[2].stiffness = 1e4;  // together 2 · 1e4 · 0.1² N m/rad about x and about y
    }
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(1e-3, 1001, 4);
    const double tilt = 1e-5;
    ForwardState initial = forward.restState();
    initial.mobile.R_GM = rotationFromVector({tilt, 0, 0});
    const Drive drive = Drive::makeFree(grid);
    const Simulation run = forward.simulate(drive, initial, 0, grid.samples, Keep::states);
    // I θ'' − i h θ' + k θ = 0 with θ = θx + i θy.
    const double half_rate = 2.0 / (2 * 0.1), root = std::sqrt(half_rate * half_rate + 200.0 / 0.1);
    const double fast = half_rate + root, slow = half_rate - root;
    const std::complex<double> i(0, 1);
    double largest_y = 0;
    for (int k = 0; k < grid.samples; k += 50) {
        const double t = grid.sampleTime(k);
        const std::complex<double> exact =
            tilt * (fast * std::exp(i * slow * t) - slow * std::exp(i * fast * t)) / (fast - slow);
        const Eigen::Vector3d theta = vectorFromRotation(forward.stateAt(run, drive, k).mobile.R_GM);
        CHECK(theta.x() == Approx(exact.real()).margin(1e-5 * tilt));
        CHECK(theta.y() == Approx(exact.imag()).margin(1e-5 * tilt));
        largest_y = std::max(largest_y, std::abs(theta.y()));
    }
    CHECK(largest_y > 0.5 * tilt);
}

TEST_CASE("small motions of body and bracket follow the matrix exponential of M, C and K") {
    MountModel model = test::makeCross();
    model.body.spin = {0.2, -0.1, 0.5};
    model.bracket = test::makeBracketModes();
    model.connections[0].axis[2].damping = 50;
    model.connections[2].axis[0].damping = 20;
    const ForwardModel forward(model);

    // Coordinates: CoG displacement, small rotation, η. Relative displacement of an end: J · coordinates.
    constexpr int n = 9;
    Eigen::MatrixXd M = Eigen::MatrixXd::Identity(n, n), C = Eigen::MatrixXd::Zero(n, n), K = C;
    M.topLeftCorner<3, 3>() *= model.body.mass;
    M.block<3, 3>(3, 3) = model.body.inertia;
    C.block<3, 3>(3, 3) = -crossMatrix(model.body.spin);  // w × h
    for (const Connection& connection : model.connections) {
        Eigen::MatrixXd J(3, n);
        J << Eigen::Matrix3d::Identity(), -crossMatrix(connection.position - model.body.center_of_gravity),
            Eigen::Matrix3d::Zero();
        for (int j = 0; j < 3; ++j) {
            const BracketMode& mode = model.bracket[j];
            J.col(6 + j) = -mode.translation - mode.rotation.cross(connection.position);
        }
        for (int axis = 0; axis < 3; ++axis) {
            const AxisLaw& law = connection.axis[axis];
            K += law.stiffness * J.row(axis).transpose() * J.row(axis);
            C += law.damping * J.row(axis).transpose() * J.row(axis);
        }
    }
    for (int j = 0; j < 3; ++j) {
        const BracketMode& mode = model.bracket[j];
        const double omega = kTwoPi * mode.frequency;
        K(6 + j, 6 + j) += omega * omega;
        C(6 + j, 6 + j) += 2 * mode.damping_ratio * omega;
    }
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n).setIdentity();
    A.bottomLeftCorner(n, n) = -M.inverse() * K;
    A.bottomRightCorner(n, n) = -M.inverse() * C;

    const double scale = 1e-7;  // products of two displacements do not count then
    Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * n);
    x.head<n>() << 1, -2, 0.5, 10, -5, 8, 3, -2, 1;
    x.tail<n>() << 30, 10, -20, 100, 200, -100, 50, 60, -40;
    x *= scale;
    ForwardState initial = forward.restState();
    initial.mobile.R_GM = rotationFromVector(x.segment<3>(3));
    initial.mobile.p_GM =
        x.head<3>() + model.body.center_of_gravity - initial.mobile.R_GM * model.body.center_of_gravity;
    initial.mobile.w_GM = x.segment<3>(n + 3);
    initial.mobile.v_GM =
        x.segment<3>(n) - initial.mobile.w_GM.cross(initial.mobile.R_GM * model.body.center_of_gravity);
    initial.eta = x.segment<3>(6);
    initial.eta_dot = x.segment<3>(n + 6);
    const TimeGrid grid = test::makeGrid(0.05, 5, 400);
    const Drive drive = Drive::makeFree(grid);
    const Simulation run = forward.simulate(drive, initial, 0, grid.samples, Keep::states);
    for (int k = 1; k < grid.samples; ++k) {
        const Eigen::VectorXd exact = (A * grid.sampleTime(k)).exp() * x;
        const ForwardState state = forward.stateAt(run, drive, k);
        const Eigen::Vector3d& c = model.body.center_of_gravity;
        Eigen::VectorXd found(9);
        found << Eigen::Vector3d(state.mobile.p_GM + state.mobile.R_GM * c - c), vectorFromRotation(state.mobile.R_GM),
            state.eta;
        CHECK((found - exact.head<n>()).norm() < 1e-4 * exact.head<n>().norm());
    }
}
