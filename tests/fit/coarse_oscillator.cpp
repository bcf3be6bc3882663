#include "tests/fit/coarse_oscillator.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/common/units.hpp"
#include "models/parameter_access.hpp"

namespace wems::test {

namespace {

double draw(std::mt19937_64& random, double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
}

struct Multisine {
    std::vector<double> frequency, phase;
    double amplitude = 0, rise = 0;  // N; s, over which it begins, 0 if it was always there

    double operator()(double t) const {
        double sum = 0;
        const double share = rise > 0 ? std::min(1.0, std::max(0.0, t / rise)) : 1;
        const double envelope = share * share * (3 - 2 * share);
        for (std::size_t i = 0; i < frequency.size(); ++i) sum += std::sin(kTwoPi * frequency[i] * t + phase[i]);
        return envelope * amplitude * sum;
    }
};

struct Motion {
    double x = 0, v = 0;
};

Motion step(const CoarseOscillator& device, const Multisine& load, double t, double h, Motion y) {
    const auto rate = [&](double time, const Motion& at) {
        const double force =
            load(time) - device.damping * at.v - device.stiffness * at.x - device.cubic * std::pow(at.x, 3);
        return Motion{at.v, force / device.mass};
    };
    const auto moved = [](const Motion& from, const Motion& by, double factor) {
        return Motion{from.x + factor * by.x, from.v + factor * by.v};
    };
    const Motion k1 = rate(t, y), k2 = rate(t + h / 2, moved(y, k1, h / 2)), k3 = rate(t + h / 2, moved(y, k2, h / 2)),
                 k4 = rate(t + h, moved(y, k3, h));
    return {y.x + h / 6 * (k1.x + 2 * k2.x + 2 * k3.x + k4.x), y.v + h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v)};
}

}  // namespace

double CoarseOscillator::interval() const {
    return kTwoPi / std::sqrt(stiffness / mass) / samples_a_period;
}

MountModel CoarseOscillator::makeModel() const {
    MountModel model;
    model.name = "oscillator";
    model.body.mass = mass;
    model.body.inertia = mass * Eigen::Matrix3d::Identity();
    model.body.free = {false, false, true, false, false, false};
    model.load_point = LoadPoint{};
    Connection connection;
    connection.name = "1";
    connection.axis[2].stiffness = stiffness;
    connection.axis[2].damping = damping;
    connection.axis[2].cubic = cubic;
    model.connections = {connection};
    setParameter(model, "mobile.1.z.zero", displacement_zero);
    setParameter(model, "load.fz.zero", load_zero);
    return model;
}

CoarseOscillator drawOscillator(std::mt19937_64& random) {
    CoarseOscillator device;
    device.mass = std::pow(10, draw(random, -1, 2));
    const double omega = kTwoPi * std::pow(10, draw(random, 0.5, 2));
    device.stiffness = device.mass * omega * omega;
    device.damping = 2 * draw(random, 0.02, 0.08) * omega * device.mass;
    device.rms = std::pow(10, draw(random, -4, -2));
    device.cubic = draw(random, 0.05, 0.3) * device.stiffness / (device.rms * device.rms);
    device.displacement_zero = draw(random, -0.1, 0.1) * device.rms;
    device.load_zero = draw(random, -0.1, 0.1) * device.rms * device.stiffness;
    device.samples_a_period = draw(random, 7, 10);
    return device;
}

Recording recordOscillator(const CoarseOscillator& device, int samples, bool from_rest, double noise,
                           std::uint64_t seed) {
    constexpr int lines = 60, substeps = 16;
    constexpr int before = 1000, rise = 60;  // samples: until the start is forgotten; until the load is there
    std::mt19937_64 random(seed);
    const double interval = device.interval();
    Multisine load;
    for (int i = 0; i < lines; ++i) {
        load.frequency.push_back((i + draw(random, 0.1, 0.9)) / lines / (3 * interval));
        load.phase.push_back(draw(random, 0, kTwoPi));
    }
    // Through a resonance of that damping, about the wanted RMS: density of the load times the half-power band.
    const double omega = std::sqrt(device.stiffness / device.mass), ratio = device.damping / (2 * omega * device.mass);
    const double lines_in_band = lines * 3 * interval * ratio * omega / 2;
    load.amplitude = device.rms * std::sqrt(2 / lines_in_band) * 2 * ratio * device.stiffness;

    if (from_rest) load.rise = rise * interval;

    Recording recording;
    recording.file = "oscillator.csv";
    recording.channels.resize(3);
    const char* names[] = {"load.fz", "mobile.1.z", "fixed.1.z"};
    const char* units[] = {"N", "m", "m"};
    for (std::size_t c = 0; c < 3; ++c) {
        recording.channels[c].name = names[c];
        recording.channels[c].unit = units[c];
    }
    Motion motion;
    double power = 0;
    for (int k = from_rest ? 0 : -before; k < samples; ++k) {
        const double t = k * interval;
        if (k >= 0) {
            recording.time.push_back(t);
            recording.channels[0].values.push_back(load(t) + device.load_zero);
            recording.channels[1].values.push_back(motion.x);
            recording.channels[2].values.push_back(0);
            power += motion.x * motion.x;
        }
        for (int s = 0; s < substeps; ++s)
            motion = step(device, load, t + s * interval / substeps, interval / substeps, motion);
    }
    std::normal_distribution<double> normal(0, noise * std::sqrt(power / samples));
    for (double& value : recording.channels[1].values) value += device.displacement_zero + normal(random);
    return recording;
}

MountModel mistake(MountModel model, double factor, std::mt19937_64& random) {
    AxisLaw& law = model.connections[0].axis[2];
    for (double* number : {&law.stiffness, &law.damping, &law.cubic})
        *number *= std::exp(draw(random, -1, 1) * std::log(factor));
    model.sensors.clear();
    return model;
}

}  // namespace wems::test
