#include "tests/fuzz/good_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "models/mount_model.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems::fuzz {
namespace {

constexpr const char* kModels = WEMS_SOURCE_DIR "/models/shipped/";
constexpr double kPi = 3.14159265358979323846;

GoodInput makeDevice() {
    const std::string file = std::string(kModels) + "smallsat_wems.toml";
    test::SweepSettings sweep;
    sweep.force = {60, 40, 300};
    sweep.octaves_per_minute = 300;
    sweep.sample_rate = 500;
    sweep.steps_per_sample = 8;
    const test::SyntheticRun run = test::simulateSweep(readMountModel(file), sweep);
    GoodInput good;
    std::ifstream stream(file);
    good.model.assign(std::istreambuf_iterator<char>(stream), {});
    const std::string modes = "smallsat_bracket.csv";
    good.model.replace(good.model.find("\"" + modes) + 1, modes.size(), "modes.csv");
    good.recording.columns.push_back({"time", "s", run.time});
    for (const Channel& channel : test::record(run, {1e-6, 0.01}, 1).channels)
        good.recording.columns.push_back({channel.name, channel.unit, channel.values});
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd load = run.load.row(axis);
        good.recording.columns.push_back({std::string("load.f") + "xyz"[axis], "N", {load.begin(), load.end()}});
    }
    return good;
}

/// A body of 2 kg between stops on a base that shakes, by the semi-implicit Euler scheme.
GoodInput makeGuidedDevice() {
    constexpr double mass = 2, stiffness = 2e4, damping = 10, clearance = 4e-4, stop = 2e5, interval = 2e-3;
    constexpr int rows = 300, steps = 40;
    GoodInput good;
    good.model =
        "name = \"guided\"\n[body]\nmass = 2.0\ninertia = [0.003, 0.003, 0.002]\nmotion = [\"z\"]\n\n[[connection]]\n"
        "name = \"1\"\nposition = [0.0, 0.0, 0.0]\n[connection.z]\nstiffness = 2.2e4\ndamping = 12.0\n"
        "stops = [ { side = \"+\", clearance = 4.2e-4, stiffness = 1.8e5 },\n"
        "          { side = \"-\", clearance = 4.2e-4, stiffness = 1.8e5 } ]\n";
    DrawnRecording::Column time{"time", "s", {}}, x{"mobile.1.z", "m", {}}, a{"mobile.1.az", "m/s^2", {}},
        u{"fixed.1.z", "m", {}}, base{"fixed.1.az", "m/s^2", {}};
    std::mt19937 generator(1);
    std::normal_distribution<double> gauss;
    double position = 0, velocity = 0;
    for (int k = 0; k < rows * steps; ++k) {
        const double t = k * interval / steps, phase = 2 * kPi * (5 * t + 30 * t * t);
        const double rate = 2 * kPi * (5 + 60 * t), shake = 3e-4 * std::sin(phase);
        const double shake_velocity = 3e-4 * rate * std::cos(phase);
        const double shake_acceleration = -rate * rate * shake + 3e-4 * 2 * kPi * 60 * std::cos(phase);
        const double q = position - shake, beyond = std::max(0.0, std::abs(q) - clearance);
        const double force = stiffness * q + damping * (velocity - shake_velocity) + std::copysign(stop * beyond, q);
        if (k % steps == 0) {
            time.values.push_back(t);
            x.values.push_back(position + 1e-6 * gauss(generator));
            a.values.push_back(-force / mass + 0.01 * gauss(generator));
            u.values.push_back(shake + 1e-6 * gauss(generator));
            base.values.push_back(shake_acceleration + 0.01 * gauss(generator));
        }
        velocity -= force / mass * interval / steps;
        position += velocity * interval / steps;
    }
    good.recording.columns = {time, x, a, u, base};
    return good;
}

/// A spring between stops with a little friction, its force measured.
GoodInput makeElement() {
    constexpr int rows = 400;
    GoodInput good;
    good.model =
        "name = \"element\"\n[body]\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\n\n[[connection]]\nname = \"1\"\n"
        "position = [0.0, 0.0, 0.0]\n[connection.z]\nstiffness = 8.0e4\ndamping = 30.0\n"
        "stops = [ { side = \"+\", clearance = 1.1e-3, stiffness = 9.0e5 } ]\n";
    DrawnRecording::Column time{"time", "s", {}}, q{"relative.1.z", "m", {}}, force{"force.1.z", "N", {}};
    for (int k = 0; k < rows; ++k) {
        const double t = 2e-3 * k, w = 2 * kPi * 3.3;
        const double at = 2e-3 * t * std::sin(w * t), rate = 2e-3 * (std::sin(w * t) + w * t * std::cos(w * t));
        time.values.push_back(t);
        q.values.push_back(at);
        force.values.push_back(1e5 * at + 50 * rate + 1e6 * std::max(0.0, at - 1e-3) + 3 * std::tanh(rate / 1e-3) +
                               0.5 * std::sin(977.0 * k));
    }
    good.recording.columns = {time, q, force};
    return good;
}

}  // namespace

std::vector<GoodInput> makeGoodInputs() {
    return {makeGuidedDevice(), makeElement(), makeDevice()};
}

}  // namespace wems::fuzz
