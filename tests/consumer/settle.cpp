// The smallest program of one's own: a box settles on its mount under gravity.
#include <Simbody.h>

#include <cstdio>

#include "models/mount_model.hpp"
#include "plugin/mount_force.hpp"

int main(int argc, char** argv) try {
    using namespace SimTK;
    const wems::MountModel model = wems::readMountModel(argc > 1 ? argv[1] : "box.toml");
    MultibodySystem system;
    SimbodyMatterSubsystem matter(system);
    GeneralForceSubsystem forces(system);
    Force::Gravity(forces, matter, Vec3(0, 0, -9.81));

    const Vec3 cog(0, 0, 0.08);
    const Inertia inertia = Inertia(0.0656, 0.1156, 0.130).shiftFromMassCenter(-cog, 12);  // about the mount's middle
    MobilizedBody::Free box(matter.Ground(), Body::Rigid(MassProperties(12, cog, inertia)));
    const wems::plugin::MountForce mount(forces, matter.Ground(), Transform(), box, Transform(), model);

    const State start = system.realizeTopology();
    RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(1e-6);
    TimeStepper stepper(system, integrator);
    stepper.initialize(start);
    stepper.stepTo(3);

    const State& end = integrator.getState();
    system.realize(end, Stage::Velocity);
    const double sag = mount.calcRelativeMotions(end)[0].q.z(), force = mount.calcConnectionForces(end)(2, 0);
    std::printf("connection %s: %.4f mm, %.2f N; dissipated %.4f J\n", model.connections[0].name.c_str(), 1e3 * sag,
                force, mount.getDissipatedEnergy(end));
    return 0;
} catch (const std::exception& error) {  // a model that cannot be read says file, line and key
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
