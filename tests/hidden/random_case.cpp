#include "tests/hidden/random_case.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "identify/forward/forward_model.hpp"
#include "identify/forward/step_size.hpp"
#include "models/bryant.hpp"
#include "models/excitation.hpp"
#include "models/pi.hpp"
#include "tests/hidden/truth_simulator.hpp"

namespace wems::hidden {
namespace {

constexpr double kSmallest = 0.03, kLargest = 0.5;  // change of the motion
constexpr double kChaotic = 30;                     // amplification
constexpr int kAttempts = 400;

double calcChange(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
}

/// Largest displacement over clearance.
double calcReach(const HiddenCase& hidden, std::size_t run) {
    const Eigen::MatrixXd q = simulateRelative(hidden, hidden.base, run);
    double reach = 0;
    for (std::size_t i = 0; i < hidden.base.connections.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a)
            for (const auto& stop : hidden.base.connections[i].axis[a].stops)
                reach = std::max(reach, (stop.side == Side::positive ? 1.0 : -1.0) / stop.clearance *
                                            q.row(static_cast<Eigen::Index>(3 * i + a)).maxCoeff());
    return reach;
}

void drawRuns(HiddenCase& hidden, Random& random) {
    hidden.octaves_per_minute = drawUniform(random, 13, 17);
    const double reach[3] = {drawUniform(random, 0.4, 0.9), drawUniform(random, 1.15, 1.5),
                             drawUniform(random, 0.8, 1.4)};
    for (std::size_t r = 0; r < 3; ++r) {
        auto& plan = hidden.runs[r];
        plan.direction = {drawUniform(random, -0.6, 0.6), drawUniform(random, -0.6, 0.6), drawUniform(random, 0.2, 1)};
        if (r == 2) plan.direction = {drawUniform(random, -1, 1), drawUniform(random, -1, 1), 0.5};
        plan.direction.normalize();
        plan.upward = r != 1 || drawInteger(random, 0, 1) == 0;
        plan.level = 60;
        for (int i = 0; i < 4; ++i) plan.level *= std::clamp(reach[r] / calcReach(hidden, r), 0.2, 5.0);
    }
}

void drawSensors(HiddenCase& hidden, Sensors sensors, Random& random) {
    const int kind = sensors == Sensors::accelerations ? 9 : drawInteger(random, 0, 9);
    if (kind < 8) hidden.displacement_noise = drawLog(random, 1e-6, 1e-5);
    if (kind >= 5) hidden.acceleration_noise = drawLog(random, 0.01, 0.1);
    hidden.gain_scatter = drawInteger(random, 0, 1) == 0 ? 0.0 : 1e-3;
}

bool isSensor(const Effect& effect) {
    return effect.cause.rfind("sensor_", 0) == 0;
}

/// `mobile.1.z` is an accelerometer where no displacement is recorded.
void nameAccelerations(HiddenCase& hidden) {
    if (hidden.displacement_noise > 0) return;
    const auto rename = [](std::string& name) {
        const auto dot = name.find('.', name.find('.') + 1);
        if (dot != std::string::npos && dot + 1 < name.size() && (dot + 2 == name.size() || name[dot + 2] == '.') &&
            name[dot + 1] >= 'x')
            name.insert(dot + 1, "a");
    };
    for (auto& effect : hidden.effects) {
        if (!isSensor(effect)) continue;
        for (auto& place : effect.where) rename(place);
        for (auto& parameter : effect.parameters) rename(parameter.first);
    }
    for (auto& sensor : hidden.truth.sensors) rename(sensor.channel);
}

/// Change by the effects, relative to the truth. Faults of sensors change no motion: they count as they are.
bool isVisible(HiddenCase& hidden) {
    double difference[2] = {0, 0}, signal[2] = {0, 0};
    for (std::size_t r = 0; r < 3; ++r) {
        const Eigen::MatrixXd truth = simulateRelative(hidden, hidden.truth, r);
        const auto group = r == 2 ? 1 : 0;
        difference[group] += (simulateRelative(hidden, hidden.base, r) - truth).squaredNorm();
        signal[group] += truth.squaredNorm();
    }
    bool visible = true;
    for (int g = 0; g < 2; ++g) {
        hidden.change[g] = std::sqrt(difference[g] / signal[g]);
        visible = visible && hidden.change[g] > kSmallest && hidden.change[g] < kLargest;
    }
    return visible;
}

bool isPredictable(HiddenCase& hidden) {
    MountModel heavier = hidden.truth;
    heavier.body.mass *= 1 + 1e-5;
    for (std::size_t r = 0; r < 3; ++r) {
        hidden.amplification[r] =
            1e5 * calcChange(simulateRelative(hidden, heavier, r), simulateRelative(hidden, hidden.truth, r));
        if (!(hidden.amplification[r] < kChaotic)) return false;
    }
    return true;
}

void drawOutside(HiddenCase& hidden, Random& random) {
    auto& outside = hidden.outside;
    outside.kind = static_cast<OutsideEffect::Kind>(drawInteger(random, 1, 4));
    outside.connection = drawInteger(random, 0, static_cast<int>(hidden.base.connections.size()) - 1);
    outside.axis = drawInteger(random, 0, 2);
    outside.other_axis = (outside.axis + drawInteger(random, 1, 2)) % 3;
    const auto& connection = hidden.base.connections[static_cast<std::size_t>(outside.connection)];
    const double stiffness = connection.axis[static_cast<std::size_t>(outside.axis)].stiffness;
    const double range = connection.axis[2].stops.front().clearance;
    outside.frequency = drawUniform(random, 2, 9);
    outside.length = range * drawUniform(random, 0.15, 0.4);
    outside.size = stiffness * drawUniform(random, 0.3, 0.7);
    if (outside.kind == OutsideEffect::Kind::disturbance) {
        outside.frequency = drawUniform(random, 12, 45);
        outside.size *= 0.15 * range;
    } else if (outside.kind == OutsideEffect::Kind::cross_axis) {
        outside.size *= 0.3 * range;
    } else if (outside.kind == OutsideEffect::Kind::buckling) {
        outside.size *= -outside.length;
    }
}

}  // namespace

double OutsideEffect::calcForce(const Eigen::Vector3d& q, double time) const {
    const double x = q[axis] / length;
    switch (kind) {
        case Kind::none:
            return 0;
        case Kind::periodic_stiffness:
            return size * q[axis] * std::sin(kTwoPi * frequency * time);
        case Kind::disturbance:
            return size * std::sin(kTwoPi * frequency * time);
        case Kind::cross_axis:
            return size * std::pow(q[other_axis] / length, 2);
        case Kind::buckling:
            return size * x * std::exp(0.5 - 0.5 * x * x);
    }
    return 0;
}

std::string formatKind(OutsideEffect::Kind kind) {
    constexpr const char* names[] = {"none", "periodic_stiffness", "disturbance", "cross_axis", "buckling"};
    return names[static_cast<int>(kind)];
}

HiddenCase drawCase(const std::string& kind, Random& random, Sensors sensors) {
    const auto& causes = listCauses();
    const auto drawCause = [&] { return causes[static_cast<std::size_t>(drawInteger(random, 0, 19))]; };
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        // The same causes are drawn again and again until a device shows them, so that no cause is rarer than others.
        static_assert(kAttempts > 20);
        HiddenCase hidden;
        hidden.kind = kind;
        hidden.base = drawDevice(random);
        drawSensors(hidden, sensors, random);
        std::vector<std::string> wanted;
        if (kind == "single") wanted = {drawCause()};
        if (kind == "two") wanted = {drawCause(), drawCause()};
        if (wanted.empty() && kind != "none" && kind != "outside") wanted = {kind};
        if (wanted.size() == 2 && wanted[0] == wanted[1]) continue;
        for (int device = 0; device < 3; ++device) {
            if (device > 0) hidden.base = drawDevice(random);
            hidden.truth = hidden.base;
            hidden.effects.clear();
            drawRuns(hidden, random);
            bool visible = true;
            for (const auto& cause : wanted) {
                HiddenCase alone = hidden;
                const Random state = random;
                hidden.effects.push_back(drawEffect(cause, hidden.base, hidden.truth, random));
                if (isSensor(hidden.effects.back())) continue;
                // Each effect must show by itself.
                Random again = state;
                alone.truth = alone.base;
                drawEffect(cause, alone.base, alone.truth, again);
                visible = visible && isVisible(alone);
            }
            if (!visible || !isPredictable(hidden)) continue;
            isVisible(hidden);
            nameAccelerations(hidden);
            if (kind == "outside") drawOutside(hidden, random);
            return hidden;
        }
    }
    throw std::runtime_error("no such case was found in " + std::to_string(kAttempts) + " attempts");
}

Eigen::MatrixXd simulateRelative(const HiddenCase& hidden, const MountModel& model, std::size_t run) {
    const auto& plan = hidden.runs[run];
    const auto sweep = plan.upward ? makeLogarithmicSweep(5, 50, hidden.octaves_per_minute)
                                   : makeLogarithmicSweep(50, 5, hidden.octaves_per_minute);
    const auto samples = static_cast<int>(sweep->duration() * hidden.rate);
    std::vector<double> time;
    Eigen::Matrix3Xd load(3, samples);
    for (int k = 0; k < samples; ++k) {
        time.push_back(k / hidden.rate);
        load.col(k) = plan.direction * plan.level * sweep->value(time.back());
    }
    const identify::TimeGrid grid{0, 1 / hidden.rate, samples, identify::chooseStepsPerSample(model, 1 / hidden.rate)};
    const auto drive = identify::Drive::makeLoad(time, load, {}, grid);
    try {
        return identify::ForwardModel(model).simulate(drive).q;
    } catch (const identify::SimulationDiverged&) {
        return Eigen::MatrixXd::Constant(3 * static_cast<Eigen::Index>(model.connections.size()), samples, 1.0);
    }
}

void addNoise(const HiddenCase& hidden, std::uint64_t seed, std::size_t run, Recording& recording) {
    Random scatter(seed), random(seed + 1 + run);
    std::normal_distribution<double> normal(0, 1);
    for (auto& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        const double gain = 1 + hidden.gain_scatter * normal(scatter);
        const double noise = name->derivative == Derivative::displacement   ? hidden.displacement_noise
                             : name->derivative == Derivative::acceleration ? hidden.acceleration_noise
                                                                            : 0.0;
        for (double& value : channel.values) value = gain * value + noise * normal(random);
    }
}

Recording recordForward(const HiddenCase& hidden, std::size_t run, std::uint64_t seed) {
    const Markers markers = simulateTruth(hidden, run);
    Recording recording;
    recording.file = "run.csv";
    recording.time = markers.time;
    const auto add = [&](const std::string& side, const Eigen::MatrixXd& truth, const std::string& prefix) {
        for (std::size_t i = 0; i < hidden.truth.connections.size(); ++i) {
            const std::string triax = side + "." + hidden.truth.connections[i].name;
            const Eigen::MatrixXd own = truth.middleRows(3 * static_cast<Eigen::Index>(i), 3);
            for (int a = 0; a < 3; ++a) {
                Channel channel;
                channel.name = triax + "." + prefix + "xyz"[a];
                channel.unit = prefix.empty() ? "m" : "m/s^2";
                double gain = 1, delay = 0;
                Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
                for (const auto& sensor : hidden.truth.sensors) {
                    if (sensor.channel != side && sensor.channel != triax && sensor.channel != channel.name) continue;
                    gain *= sensor.gain;
                    delay += sensor.delay;
                    R = rotationFromVector(sensor.rotation) * R;
                }
                const Eigen::RowVectorXd row = gain * (R.row(a) * own);
                for (Eigen::Index k = 0; k < row.size(); ++k) {
                    // Cubic through four neighbours at the delayed time.
                    const double at = std::max(0.0, static_cast<double>(k) - delay * hidden.rate);
                    const auto first = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(at) - 1, 0, row.size() - 4);
                    const double u = at - static_cast<double>(first + 1);
                    channel.values.push_back(
                        -row[first] * u * (u - 1) * (u - 2) / 6 + row[first + 1] * (u + 1) * (u - 1) * (u - 2) / 2 -
                        row[first + 2] * (u + 1) * u * (u - 2) / 2 + row[first + 3] * (u + 1) * u * (u - 1) / 6);
                }
                recording.channels.push_back(channel);
            }
        }
    };
    if (hidden.displacement_noise > 0) {
        add("mobile", markers.mobile, "");
        add("fixed", markers.fixed, "");
    }
    if (hidden.acceleration_noise > 0) {
        add("mobile", markers.mobile_acceleration, "a");
        add("fixed", markers.fixed_acceleration, "a");
    }
    addNoise(hidden, seed, run, recording);
    for (int a = 0; a < 3; ++a) {
        Channel channel;
        channel.name = std::string("load.f") + "xyz"[a];
        channel.unit = "N";
        for (Eigen::Index k = 0; k < markers.load.cols(); ++k) channel.values.push_back(markers.load(a, k));
        recording.channels.push_back(channel);
    }
    return recording;
}

}  // namespace wems::hidden
