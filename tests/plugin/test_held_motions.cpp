// Guided devices and loads on the mobile part: Simbody against the forward model, and both against what is known by
// hand.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/forward/compare.hpp"
#include "identify/forward/forward_model.hpp"
#include "identify/forward/relative_displacement.hpp"
#include "identify/forward/step_size.hpp"
#include "models/common/units.hpp"
#include "models/guided_motion.hpp"
#include "models/linear_modes.hpp"
#include "plugin/simulation.hpp"
#include "tests/models/random_values.hpp"
#include "tests/plugin/sample_models.hpp"

using namespace wems;
using plugin::simulate;
using plugin::SimulationResult;
using plugin::SimulationSettings;

namespace {

SimulationSettings makeSettings(double duration) {
    SimulationSettings settings;
    for (int k = 0; k <= static_cast<int>(duration * 1000); ++k) settings.times.push_back(k * 1e-3);
    settings.accuracy = 1e-8;
    return settings;
}

std::array<bool, 6> drawMotions(test::RandomValues& random) {
    std::array<bool, 6> free{};
    while (free == std::array<bool, 6>{})
        for (bool& motion : free) motion = random.chance();
    return free;
}

/// Root mean square of simulated − measured over that of the measured relative displacements.
double calcError(const MountModel& model, const Recording& recording) {
    const identify::RunMotion motion = identify::estimateMotion(recording, model);
    const double lowest = identify::calcRelativeDisplacement(recording, model).lowest_frequency;
    return identify::calcSimulationError(model, identify::prepareRun(motion, model, lowest)).value();
}

/// What a comparison of accelerations alone may differ by: from 0.9 of the lowest frequency on, where the sweep's own
/// start spreads below, 0.1 to 0.7 % of these short runs. Otherwise interpolation of the drive decides, below 0.1 %.
constexpr double kIntegrated = 8e-3, kMeasured = 1e-3;

/// Only the channels whose names begin so.
Recording keepChannels(const Recording& recording, const std::vector<std::string>& beginnings) {
    Recording kept = recording;
    kept.channels.clear();
    for (const Channel& channel : recording.channels)
        for (const std::string& beginning : beginnings)
            if (channel.name.rfind(beginning, 0) == 0) kept.channels.push_back(channel);
    return kept;
}

std::shared_ptr<const plugin::Drive> makeSweep(const Eigen::Vector3d& force, const Eigen::Vector3d& base) {
    return plugin::makeSignalDrive(makeLogarithmicSweep(8, 40, 60, {0.2, 0.2}), force, base, true);
}

}  // namespace

TEST_CASE("guided devices: Simbody and the forward model move alike") {
    const unsigned seed = GENERATE(range(1U, 9U));
    CAPTURE(seed);
    test::RandomValues random(seed);
    MountModel model = test::withLosses(test::makeRigidModel());
    const bool bracket = random.chance();
    if (bracket) model = test::withBracket(model);
    model.body.free = drawMotions(random);
    model.body.spin = random.vector(0.5);
    model.gravity = random.vector(5);
    model.load_point = LoadPoint{Part::mobile, random.vector(0.1)};
    CAPTURE(bracket, model.body.free);
    const auto drive = makeSweep(random.vector(30), random.vector(3));
    const SimulationResult result = simulate(model, drive, makeSettings(1.5));

    // Driven by what was recorded; nothing of the mobile part is used.
    const identify::TimeGrid grid{0, 1e-3, static_cast<int>(result.recording.sampleCount()),
                                  16 * identify::chooseStepsPerSample(model, 1e-3)};  // the bristle is stiff
    Eigen::Matrix3Xd load(3, grid.samples), base(3, grid.samples);
    for (int axis = 0; axis < 3; ++axis) {
        const auto collect = [&](Part part, Derivative derivative) {
            const Channel* channel = result.recording.find(formatChannelName({part, "", axis, derivative}));
            REQUIRE(channel != nullptr);
            return Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), grid.samples);
        };
        load.row(axis) = collect(Part::load, Derivative::force);
        base.row(axis) = collect(Part::base, Derivative::acceleration);
    }
    const auto forward_drive = identify::Drive::makeLoad(result.recording.time, load, base, grid);
    const identify::ForwardModel forward(model);
    const auto simulation = forward.simulate(forward_drive, identify::Keep::states);
    Eigen::MatrixXd q = simulation.q.colwise() - forward.restDisplacement();

    // Held coordinates stay zero.
    const GuidedMotion guide(model.body);
    double largest = 0, held = 0;
    const Bracket modes(model.bracket);
    for (int k = 0; k < grid.samples; k += 20) {
        const identify::ForwardState state = forward.stateAt(simulation, forward_drive, k);
        const FrameMotion frame = bracket ? modes.calcMotion(state.eta, state.eta_dot) : FrameMotion();
        const Vector6 s = calcRelativeCoordinates(state.mobile, frame);
        largest = std::max(largest, s.cwiseAbs().maxCoeff());
        for (const int i : guide.held()) held = std::max(held, std::abs(s[i]));
    }
    CHECK(largest > 1e-6);
    CHECK(held < 1e-13);

    // The accelerations of the mobile ends, absolute, as Simbody recorded them.
    const auto markers = forward.calcMarkers(simulation, forward_drive);
    double difference = 0, square = 0;
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const Part part : {Part::mobile, Part::fixed}) {
                const Channel* channel = result.recording.find(
                    formatChannelName({part, model.connections[i].name, axis, Derivative::acceleration}));
                const auto& simulated = part == Part::mobile ? markers.mobile_acceleration : markers.fixed_acceleration;
                const Eigen::RowVectorXd measured =
                    Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), grid.samples);
                difference += (simulated.row(static_cast<Eigen::Index>(3 * i) + axis) - measured).squaredNorm();
                square += measured.squaredNorm();
            }
        }
    }
    // The load between samples, cubic at 1 kHz and 40 Hz: 1e-5; friction's stick and slip make more of it.
    CHECK(std::sqrt(difference / square) < 2e-3);
}

TEST_CASE("a guided oscillator has the frequency of its free motion alone") {
    MountModel model = test::makeRigidModel();
    model.body.free = {false, false, true, false, false, false};
    double stiffness = 0;
    for (const Connection& connection : model.connections) stiffness += connection.axis[2].stiffness;
    const LinearModes modes = findLinearModes(linearize(model, 15));
    REQUIRE(modes.frequency.size() == 1);
    CHECK(modes.frequency[0] == Approx(std::sqrt(stiffness / model.body.mass) / kTwoPi).epsilon(1e-9));
    model.body.free = {false, false, false, true, false, false};  // about x through the origin
    double turning = 0;
    for (const Connection& connection : model.connections) {
        const Eigen::Vector3d& r = connection.position;
        turning += connection.axis[1].stiffness * r.z() * r.z() + connection.axis[2].stiffness * r.y() * r.y();
    }
    const Eigen::Vector3d& c = model.body.center_of_gravity;
    const double inertia = model.body.inertia(0, 0) + model.body.mass * (c.y() * c.y() + c.z() * c.z());
    CHECK(findLinearModes(linearize(model, 15)).frequency[0] ==
          Approx(std::sqrt(turning / inertia) / kTwoPi).epsilon(1e-7));
}

TEST_CASE("guided on a bracket: the coupled frequencies are those of two masses in line") {
    // A mode that only translates along z: the bracket is a mass on a spring, the mobile part one on another.
    MountModel model = test::makeRigidModel();
    model.body.free = {false, false, true, false, false, false};
    BracketMode mode;
    mode.frequency = 30;
    mode.translation = {0, 0, 0.3};
    model.bracket = {mode};
    double k = 0;
    for (const Connection& connection : model.connections) k += connection.axis[2].stiffness;
    const double m = model.body.mass, M = 1 / (0.3 * 0.3), K = M * std::pow(kTwoPi * 30, 2);
    // M X'' + K X + k (X − x) = 0, m x'' + k (x − X) = 0
    const double a = M * m, b = M * k + m * (K + k), c = K * k;
    const double root = std::sqrt(b * b - 4 * a * c);
    const LinearModes modes = findLinearModes(linearize(model, 15));
    REQUIRE(modes.frequency.size() == 2);
    CHECK(modes.frequency[0] == Approx(std::sqrt((b - root) / (2 * a)) / kTwoPi).epsilon(1e-8));
    CHECK(modes.frequency[1] == Approx(std::sqrt((b + root) / (2 * a)) / kTwoPi).epsilon(1e-8));
}

TEST_CASE("a guided device is known from one accelerometer, whatever drives it") {
    MountModel model = test::makeRigidModel();
    for (Connection& connection : model.connections) connection.axis[2].damping = 20;
    model.body.free = {false, false, true, false, false, false};
    const bool by_base = GENERATE(true, false);
    CAPTURE(by_base);
    if (!by_base) model.load_point = LoadPoint{Part::mobile, {0.02, 0, 0.1}};
    const auto drive = by_base ? makeSweep({0, 0, 0}, {0, 0, 2}) : makeSweep({0, 0, 40}, {0, 0, 0});
    const Recording all = simulate(model, drive, makeSettings(2.3)).recording;
    CHECK(calcError(model, all) < kMeasured);
    const std::string excitation = by_base ? "base" : "load";
    const double beside_base = by_base ? kIntegrated : kMeasured;
    CHECK(calcError(model, keepChannels(all, {"mobile.2.z", excitation})) < beside_base);
    CHECK(calcError(model, keepChannels(all, {"mobile.2.az", excitation})) < kIntegrated);
    CHECK(calcError(model, keepChannels(all, {"mobile.2.az", "mobile.1.z", "mobile.2.ax", excitation})) < beside_base);
    if (by_base) {
        CHECK(calcError(model, keepChannels(all, {"mobile.2.az", "fixed.1.az"})) < kIntegrated);
        CHECK(calcError(model, keepChannels(all, {"mobile.2.z", "fixed.3.z"})) < kMeasured);
        CHECK(calcError(model, keepChannels(all, {"mobile.2.z", "mobile.2.az", "fixed.3.z", "fixed.1.az"})) <
              kMeasured);
    }
    CHECK_THROWS_WITH(calcError(model, keepChannels(all, {"mobile.2.ax", excitation})),
                      Catch::Contains("do not determine its z"));
}

TEST_CASE("recordings with base motion: every choice of channels gives the free simulation") {
    MountModel model = test::makeRigidModel();
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.damping = 20;
    const bool bracket = GENERATE(false, true);
    CAPTURE(bracket);
    if (bracket) model = test::withBracket(model);
    for (BracketMode& mode : model.bracket) mode.base_participation = 5 * mode.translation;
    const Recording all = simulate(model, makeSweep({0, 0, 0}, {1, -0.5, 2}), makeSettings(2.3)).recording;
    std::vector<std::vector<std::string>> choices{{"mobile", "fixed", "base"}, {"mobile", "fixed"}};
    if (!bracket) choices.push_back({"mobile", "base"});
    for (const auto& choice : choices) {
        for (const char* kind : {"", "displacement", "acceleration"}) {
            CAPTURE(choice, kind);
            Recording some = keepChannels(all, choice);
            some.channels.erase(std::remove_if(some.channels.begin(), some.channels.end(),
                                               [&](const Channel& channel) {
                                                   const auto name = parseChannelName(channel.name);
                                                   if (name->part == Part::base || *kind == 0) return false;
                                                   return (name->derivative == Derivative::acceleration) !=
                                                          (std::string(kind) == "acceleration");
                                               }),
                                some.channels.end());
            const bool integrated =
                std::string(kind) == "acceleration" || (choice.back() == "base" && choice.size() == 2);
            CHECK(calcError(model, some) < (integrated ? kIntegrated : kMeasured));
        }
    }
}
