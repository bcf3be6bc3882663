// Somebody else's Simbody program: a trolley on a rail carries an instrument of its own on the mount of a WEMS model.
// Both bodies, the rail, gravity and the trolley's push are this program's; the mount is ours.
#include <Simbody.h>

#include <cmath>
#include <cstdio>

#include "models/mount_model.hpp"
#include "plugin/mount_force.hpp"

int main() {
    using namespace SimTK;
    try {
        MultibodySystem system;
        SimbodyMatterSubsystem matter(system);
        GeneralForceSubsystem forces(system);
        Force::Gravity(forces, matter, Vec3(0, 0, -9.81));

        MobilizedBody::Slider trolley(matter.Ground(),
                                      Body::Rigid(MassProperties(20, Vec3(0), Inertia(0.5, 0.5, 0.5))));
        const Vec3 cog(0, 0, 0.05);
        MobilizedBody::Free instrument(
            trolley, Transform(Vec3(0, 0, 0.3)),
            Body::Rigid(MassProperties(6, cog, Inertia(0.08, 0.08, 0.05).shiftFromMassCenter(-cog, 6))), Transform());

        const wems::MountModel model = wems::readMountModel(MODEL);
        const wems::plugin::MountForce mount(forces, trolley, Transform(Vec3(0, 0, 0.3)), instrument, Transform(),
                                             model);

        State state = system.realizeTopology();
        trolley.setOneU(state, 0, 0.05);  // the instrument starts at rest
        instrument.setUToFitLinearVelocity(state, Vec3(-0.05, 0, 0));
        system.realize(state, Stage::Dynamics);
        const double energy = system.calcEnergy(state);
        const double momentum = 20 * 0.05;

        RungeKuttaMersonIntegrator integrator(system);
        integrator.setAccuracy(1e-8);
        TimeStepper stepper(system, integrator);
        stepper.initialize(state);
        stepper.stepTo(0.5);
        const State& end = integrator.getState();
        system.realize(end, Stage::Dynamics);

        // Nothing pushes along the rail from outside, and what is lost is lost in the mount.
        const double lost = mount.getDissipatedEnergy(end);
        const double momentum_error =
            20 * trolley.getOneU(end, 0) + 6 * instrument.findStationVelocityInGround(end, cog)[0] - momentum;
        const double energy_error = system.calcEnergy(end) + lost - energy;
        std::printf("dissipated %.6g J, energy error %.2g J, momentum error %.2g N s, force on 4.z %.4g N\n", lost,
                    energy_error, momentum_error, mount.calcConnectionForces(end)(2, 3));
        return lost > 1e-4 && std::abs(energy_error) < 1e-5 * lost + 1e-7 && std::abs(momentum_error) < 1e-7 ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
