// The device in Simbody against closed forms, conserved quantities and other ways to build the same thing.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <complex>
#include <memory>

#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "plugin/mount_force.hpp"
#include "plugin/simulation.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;
using namespace wems::plugin;
using SimTK::State;
using SimTK::Transform;
using SimTK::Vec3;

namespace {

std::shared_ptr<const Drive> makeLoadDwell(double frequency, double duration, const Eigen::Vector3d& force,
                                           double fade = 0) {
    return makeSignalDrive(makeDwell(frequency, duration, {fade, 0}), force, Eigen::Vector3d::Zero(), true);
}

/// State at `duration`, integrated in one go.
State integrate(const SimTK::MultibodySystem& system, const State& start, double duration, double accuracy) {
    SimTK::RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(accuracy);
    SimTK::TimeStepper stepper(system, integrator);
    stepper.initialize(start);
    stepper.stepTo(duration);
    return integrator.getState();
}

}  // namespace

TEST_CASE("the device stays at rest in its static equilibrium") {
    MountModel model = test::withBracket(test::withLosses(test::withStops(test::makeRigidModel())));
    model.gravity = {2, -3, -9};
    model.body.spin = {0.1, -0.2, 0.4};
    Device device(model, nullptr, 0);
    const State start = device.makeRestState();
    const State end = integrate(device.system(), start, 0.3, 1e-8);
    const DeviceMotion motion = device.calcMotion(end);
    CHECK(device.body().getBodyOriginLocation(end).norm() > 1e-4);  // gravity does pull
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(motion.mobile[i].displacement.norm() < 1e-9);
        CHECK(motion.fixed[i].displacement.norm() < 1e-9);
        CHECK(motion.mobile[i].acceleration.norm() < 1e-5);
    }
}

TEST_CASE("steady vibration agrees with the frequency domain") {
    // Matrices written here, from the law's complex stiffness; the program knows nothing of them.
    MountModel model = test::withBracket(test::makeRigidModel());
    model.body.spin = {0.2, 0.3, -0.5};
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.damping = 150;
    const double ratio = 0.4, tau = 0.006;
    model.connections[0].axis[2].relaxation = Relaxation{ratio, tau};
    for (BracketMode& mode : model.bracket) mode.damping_ratio = 0.08;

    const double frequency = 22, omega = kTwoPi * frequency;
    const std::complex<double> i(0, 1);
    const Eigen::Vector3d force(20, -30, 40);
    const Eigen::Index n = 10;
    Eigen::MatrixXcd dynamic = Eigen::MatrixXcd::Zero(n, n);
    const Eigen::Matrix3d c = crossMatrix(model.body.center_of_gravity);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(n, n);
    mass.topLeftCorner<3, 3>() = model.body.mass * Eigen::Matrix3d::Identity();
    mass.block<3, 3>(0, 3) = -model.body.mass * c;
    mass.block<3, 3>(3, 0) = model.body.mass * c;
    mass.block<3, 3>(3, 3) = model.body.inertia - model.body.mass * c * c;
    dynamic -= omega * omega * mass;
    dynamic.block<3, 3>(3, 3) -= i * omega * crossMatrix(model.body.spin);  // (I ω)' = … + h × ω
    std::vector<Eigen::MatrixXd> ends;
    Eigen::VectorXd load = Eigen::VectorXd::Zero(n);
    for (int j = 0; j < 4; ++j) {
        const BracketMode& mode = model.bracket[j];
        const double natural = kTwoPi * mode.frequency;
        dynamic(6 + j, 6 + j) += natural * natural + 2.0 * i * omega * mode.damping_ratio * natural;
        load(6 + j) = mode.load_translation.dot(force);
    }
    for (const Connection& connection : model.connections) {
        const Eigen::Matrix3d r = crossMatrix(connection.position);
        Eigen::MatrixXd G(3, n);
        G.leftCols<3>() = Eigen::Matrix3d::Identity();
        G.middleCols<3>(3) = -r;
        for (int j = 0; j < 4; ++j) {
            const BracketMode& mode = model.bracket[j];
            G.col(6 + j) = -(mode.translation - r * mode.rotation);
        }
        for (int k = 0; k < 3; ++k) {
            const AxisLaw& law = connection.axis[k];
            std::complex<double> stiffness = law.stiffness + i * omega * law.damping;
            if (law.relaxation) stiffness += law.stiffness * ratio * i * omega * tau / (1.0 + i * omega * tau);
            dynamic += stiffness * (G.row(k).transpose() * G.row(k)).cast<std::complex<double>>();
        }
        ends.push_back(G);
    }
    const Eigen::VectorXcd amplitude = dynamic.partialPivLu().solve(load.cast<std::complex<double>>());

    SimulationSettings settings;
    settings.times.push_back(0.0);
    for (int k = 0; k <= 100; ++k) settings.times.push_back(3.0 + 0.001 * k);
    settings.accuracy = 1e-9;
    settings.channels.acceleration = true;
    const SimulationResult result = simulate(model, makeLoadDwell(frequency, 4, force, 1.0), settings);
    for (std::size_t connection = 0; connection < 3; ++connection) {
        const Eigen::Vector3cd expected = ends[connection] * amplitude;
        for (int k = 0; k < 3; ++k) {
            const std::string name = std::to_string(connection + 1) + "." + "xyz"[k];
            const auto& mobile = result.recording.find("mobile." + name)->values;
            const auto& fixed = result.recording.find("fixed." + name)->values;
            double worst = 0;
            for (std::size_t s = 1; s < settings.times.size(); ++s)
                worst = std::max(worst, std::abs(mobile[s] - fixed[s] -
                                                 (expected[k] * std::exp(i * omega * settings.times[s])).imag()));
            CAPTURE(name, worst);
            REQUIRE(expected.norm() > 1e-5);
            CHECK(worst < 1e-3 * expected.norm());
        }
    }
}

namespace {

/// The fixed part as bodies: one unit-mass slider for each mode, and a force that couples them through the shapes.
class SliderForce : public SimTK::Force::Custom::Implementation {
public:
    SliderForce(const MountModel& model, SimTK::MobilizedBody body, std::vector<SimTK::MobilizedBody::Slider> sliders,
                std::shared_ptr<const Drive> drive)
        : laws_(model), bracket_(model.bracket), body_(body), sliders_(std::move(sliders)), drive_(std::move(drive)) {}
    void calcForce(const State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces, SimTK::Vector_<Vec3>&,
                   SimTK::Vector& mobility_forces) const override {
        Eigen::VectorXd eta(4), eta_dot(4), eta_dot_dot(4);
        for (int j = 0; j < 4; ++j) {
            eta[j] = sliders_[j].getLength(state);
            eta_dot[j] = sliders_[j].getRate(state);
        }
        Wrench on_mobile, on_fixed;
        laws_.calc(calcFrameMotion(body_, Transform(), state), bracket_.calcMotion(eta, eta_dot), state.getTime(),
                   nullptr, on_mobile, on_fixed, nullptr);
        body_forces[body_.getMobilizedBodyIndex()] += toSimTK(on_mobile);
        bracket_.calcAccelerations(eta, eta_dot, on_fixed, drive_->calcLoad(state.getTime()), Eigen::Vector3d::Zero(),
                                   eta_dot_dot);
        for (int j = 0; j < 4; ++j) sliders_[j].applyOneMobilityForce(state, 0, eta_dot_dot[j], mobility_forces);
    }
    SimTK::Real calcPotentialEnergy(const State&) const override { return 0; }

private:
    MountForces laws_;
    Bracket bracket_;
    SimTK::MobilizedBody body_;
    std::vector<SimTK::MobilizedBody::Slider> sliders_;
    std::shared_ptr<const Drive> drive_;
};

}  // namespace

TEST_CASE("bracket modes as auxiliary states move like bodies on sliders") {
    MountModel model = test::withBracket(test::withStops(test::makeRigidModel()));
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.damping = 15;
    const auto drive = makeLoadDwell(31, 1, {150, 80, 300});
    Device device(model, drive, 1);
    const State with_states = integrate(device.system(), device.makeRestState(), 0.15, 1e-10);

    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter(system);
    SimTK::GeneralForceSubsystem forces(system);
    SimTK::MobilizedBody::Bushing body(matter.Ground(), SimTK::Body::Rigid(makeMassProperties(model.body)));
    std::vector<SimTK::MobilizedBody::Slider> sliders;
    for (int j = 0; j < 4; ++j)
        sliders.emplace_back(matter.Ground(),
                             SimTK::Body::Rigid(SimTK::MassProperties(1, Vec3(0), SimTK::Inertia(1e-3))));
    SimTK::Force::Custom(forces, new SliderForce(model, body, sliders, drive));
    const State with_bodies = integrate(system, system.realizeTopology(), 0.15, 1e-10);

    device.system().realize(with_states, SimTK::Stage::Velocity);
    system.realize(with_bodies, SimTK::Stage::Velocity);
    double deepest = 0;
    for (const RelativeMotion& relative : device.calcMotion(with_states).relative)
        deepest = std::max(deepest, relative.q.cwiseAbs().maxCoeff());
    CHECK(deepest > 2e-4);
    CHECK((device.body().getQ(with_states) - body.getQ(with_bodies)).norm() < 1e-9);
    const Eigen::VectorXd eta = device.force().getEta(with_states);
    for (int j = 0; j < 4; ++j) CHECK(std::abs(eta[j] - sliders[j].getLength(with_bodies)) < 1e-9);
}

TEST_CASE("base acceleration moves the device like a base that moves") {
    const MountModel model = test::withLosses(test::withStops(test::makeRigidModel()));
    const double frequency = 20, omega = kTwoPi * frequency, level = 60, duration = 0.2;
    const auto drive = makeSignalDrive(makeDwell(frequency, 1), Eigen::Vector3d::Zero(), {0, 0, level}, true);
    Device device(model, drive, duration);
    const State accelerated = integrate(device.system(), device.makeRestState(), duration, 1e-9);

    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter(system);
    SimTK::GeneralForceSubsystem forces(system);
    // x'' = a sin ωt: x = −a/ω² sin ωt, the device starting with the base's velocity −a/ω.
    SimTK::MobilizedBody::Slider base(matter.Ground(), Transform(SimTK::Rotation(-SimTK::Pi / 2, SimTK::YAxis)),
                                      SimTK::Body::Rigid(SimTK::MassProperties(1, Vec3(0), SimTK::Inertia(1))),
                                      Transform(SimTK::Rotation(-SimTK::Pi / 2, SimTK::YAxis)));
    SimTK::Motion::Sinusoid motion(base, SimTK::Motion::Position, -level / (omega * omega), omega, 0);
    SimTK::MobilizedBody::Bushing body(matter.Ground(), SimTK::Body::Rigid(makeMassProperties(model.body)));
    MountForce mount(forces, base, Transform(), body, Transform(), model);
    State start = system.realizeTopology();
    body.setUToFitLinearVelocity(start, Vec3(0, 0, -level / omega));
    const State moved = integrate(system, start, duration, 1e-9);

    system.realize(moved, SimTK::Stage::Velocity);
    const auto expected = mount.calcRelativeMotions(moved);
    const auto actual = device.calcMotion(accelerated).relative;
    for (std::size_t i = 0; i < 3; ++i) {
        REQUIRE(expected[i].q.norm() > 1e-4);
        CHECK((actual[i].q - expected[i].q).norm() < 1e-7);
        CHECK((actual[i].v - expected[i].v).norm() < 1e-4);
    }
}

TEST_CASE("a free body with a wheel keeps angular momentum and kinetic energy") {
    MountModel model;
    model.body.mass = 4;
    model.body.inertia << 0.05, 0.004, -0.003, 0.004, 0.06, 0.002, -0.003, 0.002, 0.04;
    model.body.spin = {0.3, -0.1, 0.6};
    Connection connection;
    connection.name = "1";
    model.connections.push_back(connection);  // no law at all: no force
    Device device(model, nullptr, 0);
    State start = device.makeRestState();
    device.body().setUToFitAngularVelocity(start, Vec3(1.5, -0.7, 0.4));
    const State end = integrate(device.system(), start, 0.5, 1e-10);
    const auto calcMomentum = [&](const State& state) -> Eigen::Vector3d {
        device.system().realize(state, SimTK::Stage::Velocity);
        const BodyMotion motion = calcFrameMotion(device.body(), Transform(), state);
        return motion.R_GM * (model.body.inertia * (motion.R_GM.transpose() * motion.w_GM) + model.body.spin);
    };
    const Eigen::Vector3d before = calcMomentum(start), after = calcMomentum(end);
    CHECK((after - before).norm() < 1e-8);
    CHECK(device.calcTotalEnergy(end) == Approx(device.calcTotalEnergy(start)).epsilon(1e-8));
    const double turned = (end.getQ() - start.getQ()).norm();
    CHECK(turned > 0.1);
}

TEST_CASE("energy of the free device, bracket and losses included, stays constant") {
    MountModel model = test::withBracket(test::withLosses(test::withStops(test::makeRigidModel())));
    model.gravity = {0, 0, -9.81};
    Device device(model, nullptr, 0);
    State start = device.makeRestState();
    device.body().setU(start, SimTK::Vec6(0.8, -1.0, 0.5, 0.3, 0.2, -0.4));
    const double before = device.calcTotalEnergy(start);
    const State end = integrate(device.system(), start, 0.25, 1e-8);
    const double lost = device.force().getDissipatedEnergy(end);
    CAPTURE(before, lost);
    REQUIRE(lost > 0.05);
    CHECK(std::abs(device.calcTotalEnergy(end) - before) < 1e-6 * lost);
}

TEST_CASE("another integrator arrives at the same place") {
    const MountModel model = test::withBracket(test::withLosses(test::withStops(test::makeRigidModel())));
    const auto drive = makeLoadDwell(31, 1, {150, 80, 300});
    Device device(model, drive, 1);
    const State start = device.makeRestState();
    const State merson = integrate(device.system(), start, 0.1, 1e-9);
    SimTK::CPodesIntegrator backward(device.system(), SimTK::CPodes::BDF);
    backward.setAccuracy(1e-9);
    SimTK::TimeStepper stepper(device.system(), backward);
    stepper.initialize(start);
    stepper.stepTo(0.1);
    const double moved = (merson.getQ() - start.getQ()).norm();
    REQUIRE(moved > 1e-3);
    CHECK((merson.getQ() - backward.getState().getQ()).norm() < 1e-6);
}

TEST_CASE("values change between two runs of one system, without new topology") {
    const MountModel model = test::withBracket(test::withStops(test::makeRigidModel()));
    MountModel changed = model;
    for (Connection& connection : changed.connections) connection.axis[2].stiffness *= 1.3;
    changed.bracket[1].frequency = 44;
    const auto drive = makeLoadDwell(31, 1, {50, 80, 100});
    Device device(model, drive, 1), anew(changed, drive, 1);
    State state = device.makeRestState();
    const auto version = device.system().getSystemTopologyCacheVersion();
    device.force().setModel(state, changed);
    const State end = integrate(device.system(), state, 0.1, 1e-8);
    const State expected = integrate(anew.system(), anew.makeRestState(), 0.1, 1e-8);
    CHECK(device.system().getSystemTopologyCacheVersion() == version);
    CHECK((end.getY() - expected.getY()).norm() == 0);  // the same numbers in the same order
}
