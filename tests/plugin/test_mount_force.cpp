// The force element between two bodies of somebody else's system.
#include <catch2/catch.hpp>
#include <memory>
#include <random>

#include "models/common/error.hpp"
#include "plugin/mount_force.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;
using namespace wems::plugin;
using SimTK::MobilizedBody;
using SimTK::Rotation;
using SimTK::SpatialVec;
using SimTK::State;
using SimTK::Transform;
using SimTK::Vec3;

namespace {

/// Two free bodies and a mount between frames that sit somewhere on them; the whole world may be turned.
struct TwoBodies {
    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter{system};
    SimTK::GeneralForceSubsystem forces{system};
    MobilizedBody::Free base, device;
    MountForce mount;
    Transform X_BaseF, X_DeviceM;

    /// @param mount_on_swapped builds the device before the base, so that the tree's order changes
    TwoBodies(const MountModel& model, bool swapped, const Vec3& gravity = Vec3(0))
        : X_BaseF(Rotation(0.4, SimTK::UnitVec3(1, 2, -1)), Vec3(0.03, -0.02, 0.05)),
          X_DeviceM(Rotation(-0.7, SimTK::UnitVec3(0.3, -1, 2)), Vec3(-0.01, 0.04, 0.02)) {
        const SimTK::Body::Rigid base_body(
            SimTK::MassProperties(11, Vec3(0.01, 0, 0.02),
                                  SimTK::UnitInertia(0.02, 0.03, 0.025).shiftFromMassCenter(Vec3(0.01, 0, 0.02), 1)));
        const SimTK::Body::Rigid device_body(makeMassProperties(model.body));
        if (swapped) {
            device = MobilizedBody::Free(matter.Ground(), device_body);
            base = MobilizedBody::Free(matter.Ground(), base_body);
        } else {
            base = MobilizedBody::Free(matter.Ground(), base_body);
            device = MobilizedBody::Free(matter.Ground(), device_body);
        }
        if (gravity.norm() > 0) SimTK::Force::Gravity(forces, matter, gravity);
        mount = MountForce(forces, base, X_BaseF, device, X_DeviceM, model);
    }

    /// Base at X_GBase, M displaced from F by millimetres and milliradians, everything seen from a turned world.
    State makeState(const Rotation& world = Rotation()) {
        State state = system.realizeTopology();
        const Transform X_GW(world);
        const Transform X_GBase = X_GW * Transform(Rotation(0.9, SimTK::UnitVec3(1, 1, 3)), Vec3(0.2, 0.1, -0.3));
        const Transform X_FM(Rotation(0.02, SimTK::UnitVec3(1, -2, 1)), Vec3(1.5e-3, -0.9e-3, 2e-3));
        base.setQToFitTransform(state, X_GBase);
        device.setQToFitTransform(state, X_GBase * X_BaseF * X_FM * ~X_DeviceM);
        base.setUToFitVelocity(state, SpatialVec(world * Vec3(0.3, -0.2, 0.5), world * Vec3(0.1, 0.2, -0.05)));
        device.setUToFitVelocity(state, SpatialVec(world * Vec3(-0.1, 0.4, 0.2), world * Vec3(0.15, 0.1, 0.1)));
        return state;
    }
};

/// Sum of the body forces, moments taken about the ground origin.
SpatialVec sumWrench(TwoBodies& bodies, const State& state) {
    bodies.system.realize(state, SimTK::Stage::Dynamics);
    const auto& body_forces = bodies.system.getRigidBodyForces(state, SimTK::Stage::Dynamics);
    SpatialVec sum(Vec3(0), Vec3(0));
    for (const MobilizedBody& body :
         {static_cast<MobilizedBody>(bodies.base), static_cast<MobilizedBody>(bodies.device)}) {
        const SpatialVec& force = body_forces[body.getMobilizedBodyIndex()];
        sum += SpatialVec(force[0] + body.getBodyOriginLocation(state) % force[1], force[1]);
    }
    return sum;
}

}  // namespace

TEST_CASE("total force and total moment of the mount are zero") {
    TwoBodies bodies(test::withLosses(test::withStops(test::makeRigidModel())), false);
    const State state = bodies.makeState();
    const SpatialVec sum = sumWrench(bodies, state);
    const SpatialVec& on_device =
        bodies.system.getRigidBodyForces(state, SimTK::Stage::Dynamics)[bodies.device.getMobilizedBodyIndex()];
    REQUIRE(on_device[1].norm() > 100);  // the forces that cancel are large
    CHECK(sum[1].norm() < 1e-12 * on_device[1].norm());
    CHECK(sum[0].norm() < 1e-12 * on_device[1].norm());
}

TEST_CASE("force of one connection by hand") {
    // A single connection at the origins of both frames, pure translation: nothing but Hooke, dashpot and stop.
    MountModel model = test::makeRigidModel();
    model.connections.resize(1);
    model.connections[0].position.setZero();
    model.connections[0].axis = {};
    model.connections[0].axis[2].stiffness = 1e4;
    model.connections[0].axis[2].damping = 50;
    model.connections[0].axis[2].stops.push_back({Side::positive, 1e-3, 1e5, 0});
    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter(system);
    SimTK::GeneralForceSubsystem forces(system);
    MobilizedBody::Free device(matter.Ground(), SimTK::Body::Rigid(makeMassProperties(model.body)));
    const Transform X_GF(Vec3(1, 2, 3));
    MountForce mount(forces, matter.Ground(), X_GF, device, Transform(), model);
    State state = system.realizeTopology();
    device.setQToFitTransform(state, Transform(X_GF.p() + Vec3(0, 0, 3e-3)));
    device.setUToFitVelocity(state, SpatialVec(Vec3(0), Vec3(0, 0, 0.2)));
    system.realize(state, SimTK::Stage::Dynamics);
    const SpatialVec force = system.getRigidBodyForces(state, SimTK::Stage::Dynamics)[device.getMobilizedBodyIndex()];
    CHECK(force[1][2] == Approx(-(1e4 * 3e-3 + 50 * 0.2 + 1e5 * 2e-3)).epsilon(1e-12));
    CHECK(std::abs(force[1][0]) + std::abs(force[1][1]) + force[0].norm() < 1e-9);
    CHECK(mount.calcRelativeMotions(state)[0].q.z() == Approx(3e-3).epsilon(1e-12));
    CHECK(mount.calcConnectionForces(state)(2, 0) == Approx(240).epsilon(1e-12));
}

TEST_CASE("neither the world's axes nor the order of the bodies matters") {
    const MountModel model = test::withLosses(test::withStops(test::makeRigidModel()));
    const Vec3 gravity(1, -9, 3);
    const Rotation world(1.1, SimTK::UnitVec3(2, -1, 0.5));
    TwoBodies straight(model, false, gravity), turned(model, false, world * gravity), swapped(model, true, gravity);
    State states[3] = {straight.makeState(), turned.makeState(world), swapped.makeState()};
    TwoBodies* worlds[3] = {&straight, &turned, &swapped};
    Vec3 positions[3];
    double energies[3];
    for (int i = 0; i < 3; ++i) {
        SimTK::RungeKuttaMersonIntegrator integrator(worlds[i]->system);
        integrator.setAccuracy(1e-10);
        SimTK::TimeStepper stepper(worlds[i]->system, integrator);
        stepper.initialize(states[i]);
        stepper.stepTo(0.05);
        positions[i] = worlds[i]->device.getBodyOriginLocation(integrator.getState());
        energies[i] = worlds[i]->mount.getDissipatedEnergy(integrator.getState());
    }
    positions[1] = ~world * positions[1];
    straight.system.realize(states[0], SimTK::Stage::Position);
    const double moved = (positions[0] - straight.device.getBodyOriginLocation(states[0])).norm();
    REQUIRE(moved > 1e-3);
    CHECK((positions[1] - positions[0]).norm() < 1e-8);
    CHECK((positions[2] - positions[0]).norm() < 1e-8);
    CHECK(energies[1] == Approx(energies[0]).epsilon(1e-6));
    CHECK(energies[2] == Approx(energies[0]).epsilon(1e-6));
}

TEST_CASE("energy and dissipation together stay constant, better with better accuracy") {
    TwoBodies bodies(test::withLosses(test::withStops(test::makeRigidModel())), false);
    const auto calcDrift = [&](double accuracy) {
        State state = bodies.makeState();
        bodies.system.realize(state, SimTK::Stage::Dynamics);
        const double before = bodies.system.calcEnergy(state);
        SimTK::RungeKuttaMersonIntegrator integrator(bodies.system);
        integrator.setAccuracy(accuracy);
        SimTK::TimeStepper stepper(bodies.system, integrator);
        stepper.initialize(state);
        stepper.stepTo(0.3);
        const State& end = integrator.getState();
        bodies.system.realize(end, SimTK::Stage::Dynamics);
        const double lost = bodies.mount.getDissipatedEnergy(end);
        REQUIRE(lost > 0.05);
        return std::abs(bodies.system.calcEnergy(end) + lost - before) / lost;
    };
    for (const auto& [accuracy, limit] : {std::pair{1e-5, 1e-2}, {1e-7, 1e-4}, {1e-9, 1e-6}}) {
        CAPTURE(accuracy);
        CHECK(calcDrift(accuracy) < limit);
    }
    CHECK(calcDrift(1e-9) < calcDrift(1e-5));
}

TEST_CASE("laws change in the state, without new topology") {
    const MountModel soft = test::withLosses(test::withStops(test::makeRigidModel()));
    MountModel stiff = soft;
    for (Connection& connection : stiff.connections)
        for (AxisLaw& law : connection.axis) {
            law.stiffness *= 1.7;
            for (Stop& stop : law.stops) stop.clearance *= 0.8;
        }
    TwoBodies bodies(soft, false), anew(stiff, false);
    State state = bodies.makeState();
    bodies.system.realize(state, SimTK::Stage::Dynamics);
    const auto version = bodies.system.getSystemTopologyCacheVersion();
    const Eigen::Matrix3Xd before = bodies.mount.calcConnectionForces(state);
    bodies.mount.setLaws(state, stiff);
    CHECK(state.getSystemStage() == SimTK::Stage::Velocity);  // nothing before the forces is computed again
    bodies.system.realize(state, SimTK::Stage::Dynamics);
    CHECK(bodies.system.getSystemTopologyCacheVersion() == version);

    const State reference = anew.makeState();
    anew.system.realize(reference, SimTK::Stage::Dynamics);
    const Eigen::Matrix3Xd expected = anew.mount.calcConnectionForces(reference);
    REQUIRE((expected - before).norm() > 0.1 * before.norm());
    CHECK((bodies.mount.calcConnectionForces(state) - expected).norm() < 1e-12 * expected.norm());

    MountModel another = soft;
    another.connections[0].axis[1].relaxation = Relaxation{0.1, 0.02};
    CHECK_THROWS_AS(bodies.mount.setLaws(state, another), InputError);
    another = soft;
    another.connections.pop_back();
    CHECK_THROWS_AS(bodies.mount.setLaws(state, another), InputError);
}

TEST_CASE("a law that cannot be used is refused at construction, by name") {
    MountModel model = test::makeRigidModel();
    model.connections[1].axis[2].stiffness = std::nan("");
    try {
        TwoBodies bodies(model, false);
        FAIL("no exception");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()).find("connection[1].z.stiffness") != std::string::npos);
    }
}
