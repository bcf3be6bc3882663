// Somebody else's Simbody program, recorded: a table that shakes along three axes carries an instrument on the mount of
// a model. Writes what twelve sensors on either side of the mount would record, for `identify`.
//   shaking_table MODEL.toml RUN.csv
#include <Simbody.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording_writer.hpp"
#include "plugin/mount_force.hpp"

using namespace SimTK;

namespace {

Vec3 toSimbody(const ::Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// A slide along the x axis of `along` that moves as a cosine, m and Hz: it starts at rest.
MobilizedBody::Slider addSlide(MobilizedBody& carrier, const Rotation& along, double amplitude, double frequency) {
    const Body::Rigid slide(MassProperties(5, Vec3(0), Inertia(0.1, 0.1, 0.1)));
    MobilizedBody::Slider body(carrier, Transform(along), slide, Transform(along));
    Motion::Sinusoid(body, Motion::Position, amplitude, 2 * Pi * frequency, Pi / 2);
    return body;
}

/// Displacement from rest and acceleration of one end of a connection.
struct Sensor {
    std::string name;  // mobile.1
    const MobilizedBody& body;
    Vec3 station;
    Vec3 rest = Vec3(0);  // where the run starts

    void addChannels(wems::Recording& recording) const {
        for (const char* quantity : {"x", "y", "z"}) recording.channels.push_back({name + "." + quantity, "m", {}, 0});
        for (const char* quantity : {"ax", "ay", "az"})
            recording.channels.push_back({name + "." + quantity, "m/s^2", {}, 0});
    }
    /// @param channel the first of this sensor's
    void sample(const State& state, wems::Channel* channel) {
        const Vec3 location = body.findStationLocationInGround(state, station);
        if (channel->values.empty()) rest = location;
        const Vec3 displacement = location - rest;
        const Vec3 acceleration = body.findStationAccelerationInGround(state, station);
        for (int i = 0; i < 3; ++i) channel[i].values.push_back(displacement[i]);
        for (int i = 0; i < 3; ++i) channel[3 + i].values.push_back(acceleration[i]);
    }
};

void run(const std::string& model_file, const std::string& output) {
    const wems::MountModel model = wems::readMountModel(model_file);
    MultibodySystem system;
    SimbodyMatterSubsystem matter(system);
    GeneralForceSubsystem forces(system);

    MobilizedBody::Slider lowest = addSlide(matter.Ground(), Rotation(), 4e-4, 9);
    MobilizedBody::Slider middle = addSlide(lowest, Rotation(Pi / 2, ZAxis), 2e-4, 14);
    MobilizedBody::Slider table = addSlide(middle, Rotation(-Pi / 2, YAxis), 1e-4, 31);
    const Vec3 cog = toSimbody(model.body.center_of_gravity);
    const ::Eigen::Matrix3d& I = model.body.inertia;
    const Inertia inertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    MobilizedBody::Free instrument(
        table, Transform(),
        Body::Rigid(MassProperties(model.body.mass, cog, inertia.shiftFromMassCenter(-cog, model.body.mass))),
        Transform());
    const wems::plugin::MountForce mount(forces, table, Transform(), instrument, Transform(), model);

    std::vector<Sensor> sensors;
    for (const auto& connection : model.connections) {
        sensors.push_back({"mobile." + connection.name, instrument, toSimbody(connection.position)});
        sensors.push_back({"fixed." + connection.name, table, toSimbody(connection.position)});
    }
    wems::Recording recording;
    for (const Sensor& sensor : sensors) sensor.addChannels(recording);

    RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(1e-8);
    TimeStepper stepper(system, integrator);
    stepper.initialize(system.realizeTopology());
    for (int k = 0; k <= 3000; ++k) {
        stepper.stepTo(k / 1000.0);
        const State& state = stepper.getState();
        system.realize(state, Stage::Acceleration);
        recording.time.push_back(k / 1000.0);
        for (std::size_t i = 0; i < sensors.size(); ++i) sensors[i].sample(state, &recording.channels[6 * i]);
    }
    wems::writeRecording(recording, output);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 3) throw std::invalid_argument("usage: shaking_table MODEL.toml RUN.csv");
        run(argv[1], argv[2]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "shaking_table: %s\n", error.what());
        return 2;
    }
}
