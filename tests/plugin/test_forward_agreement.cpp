// The fast forward model against Simbody: two integrators, two formulations of the rigid body, the same laws.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <utility>

#include "identify/forward/forward_model.hpp"
#include "identify/forward/step_size.hpp"
#include "plugin/simulation.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

using namespace wems;

namespace {

constexpr double kInterval = 1e-3;  // s
constexpr double kAfter = 0.15;     // s, window from the first contact on
constexpr double kEnvelope = 0.1;   // s, over which an envelope takes the largest displacement
constexpr int kFiner = 8;
constexpr double kLoadInterval = 1e-4;  // s: interpolating the load must not be what differs

/// A random device with every extended law somewhere; a different one with each draw.
MountModel drawExtendedDevice(hidden::Random& random) {
    MountModel base = hidden::drawDevice(random), model = base;
    for (const char* cause : {"friction", "relaxation", "cubic_stiffness", "hysteresis", "stop_dissipation",
                              "gyroscopic", "preload", "stiffness_drift", "structural_damping"})
        hidden::drawEffect(cause, base, model, random);
    // A softening axis without stops could run away.
    for (auto& connection : model.connections)
        for (auto& law : connection.axis) law.cubic = std::abs(law.cubic);
    model.connections[0].axis[0].friction = Friction{hidden::drawUniform(random, 1, 5), 1e-3, 5e4};
    return model;
}

struct Run {
    std::shared_ptr<const Signal> signal;
    Eigen::Vector3d force;
    int samples() const { return static_cast<int>(signal->duration() / kInterval); }
};

/// Motion of the mobile ends beyond that of the fixed ones: row 3 i + axis, and the same relative to the clearances.
struct Motion {
    Eigen::MatrixXd relative;
    double reach = 0;
    int first_contact = 0;  ///< sample; the number of samples if there is none
};

Motion simulateForward(const MountModel& model, const Run& run, int finer = 1) {
    const identify::TimeGrid grid{0, kInterval, run.samples(),
                                  finer * identify::chooseStepsPerSample(model, kInterval)};
    std::vector<double> time;
    const auto count = static_cast<Eigen::Index>(run.samples() * kInterval / kLoadInterval) + 2;
    Eigen::Matrix3Xd load(3, count);
    for (Eigen::Index k = 0; k < count; ++k) {
        time.push_back(static_cast<double>(k) * kLoadInterval);
        load.col(k) = run.force * run.signal->value(time.back());
    }
    const auto drive = identify::Drive::makeLoad(time, load, {}, grid);
    const identify::ForwardModel forward(model);
    const auto simulation = forward.simulate(drive, identify::Keep::states);
    const auto markers = forward.calcMarkers(simulation, drive);
    Motion motion;
    motion.relative = markers.mobile_displacement - markers.fixed_displacement;
    motion.first_contact = run.samples();
    for (Eigen::Index row = 0; row < simulation.q.rows(); ++row) {
        const auto& law = model.connections[row / 3].axis[row % 3];
        for (const auto& stop : law.stops)
            for (int k = 0; k < run.samples(); ++k) {
                const double q = simulation.q(row, k) + law.offset;
                const double reach = (stop.side == Side::positive ? q : -q) / stop.clearance;
                motion.reach = std::max(motion.reach, reach);
                if (reach > 1) motion.first_contact = std::min(motion.first_contact, k);
            }
    }
    return motion;
}

Eigen::MatrixXd simulateSimbody(const MountModel& model, const Run& run) {
    plugin::SimulationSettings settings;
    for (int k = 0; k < run.samples(); ++k) settings.times.push_back(k * kInterval);
    settings.channels = {true, false, false};
    settings.accuracy = 1e-8;
    settings.longest_step = 0.5e-3;
    const auto drive = plugin::makeSignalDrive(run.signal, run.force, Eigen::Vector3d::Zero(), true);
    const auto recording = plugin::simulate(model, drive, settings).recording;
    Eigen::MatrixXd relative(3 * model.connections.size(), run.samples());
    for (Eigen::Index row = 0; row < relative.rows(); ++row) {
        const std::string end = model.connections[row / 3].name + "." + "xyz"[row % 3];
        const auto &mobile = recording.find("mobile." + end)->values, &fixed = recording.find("fixed." + end)->values;
        for (int k = 0; k < run.samples(); ++k) relative(row, k) = mobile[k] - fixed[k];
    }
    return relative;
}

/// RMS of the difference over RMS of the motion, samples `first` to `last`.
double calcDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int first, int last) {
    const auto middle = [&](const Eigen::MatrixXd& m) { return m.middleCols(first, last - first); };
    return (middle(a) - middle(b)).norm() / middle(b).norm();
}

Eigen::MatrixXd calcEnvelope(const Eigen::MatrixXd& motion) {
    const auto width = static_cast<Eigen::Index>(kEnvelope / kInterval);
    Eigen::MatrixXd envelope(motion.rows(), motion.cols() / width);
    for (Eigen::Index k = 0; k < envelope.cols(); ++k)
        envelope.col(k) = motion.middleCols(k * width, width).cwiseAbs().rowwise().maxCoeff();
    return envelope;
}

/// Relative differences: before the first contact, shortly after it, overall, of the envelopes; and the first two with
/// an eighth of the forward model's own step.
struct Agreement {
    double reach = 0, before = 0, after = 0, whole = 0, envelope = 0, fine_before = 0, fine_after = 0;
};

/// A sweep of two octaves in two seconds, as hard as presses the stops by some tenths of the clearance. Empty where no
/// such level is found: a device may be soft enough to run away, or jump over the levels in question.
std::optional<Run> findRun(const MountModel& model, hidden::Random& random) {
    const bool upward = hidden::drawInteger(random, 0, 1) == 0;
    Run run{upward ? makeLogarithmicSweep(11, 44, 60) : makeLogarithmicSweep(44, 11, 60), {}};
    Eigen::Vector3d direction(hidden::drawUniform(random, -0.5, 0.5), hidden::drawUniform(random, -0.5, 0.5), 1);
    run.force = 100 * direction.normalized();
    const double wanted = hidden::drawUniform(random, 1.2, 1.5);
    try {
        for (int i = 0; i < 12; ++i) {
            const Motion motion = simulateForward(model, run);
            const bool in_between = motion.first_contact > 0 && motion.first_contact < run.samples();
            if (in_between && std::abs(motion.reach / wanted - 1) < 0.1) return run;
            run.force *= std::clamp(wanted / motion.reach, 0.2, 5.0);
        }
    } catch (const identify::SimulationDiverged&) {
        return std::nullopt;
    }
    return std::nullopt;
}

Agreement compareOn(const MountModel& model, const Run& run) {
    const Motion motion = simulateForward(model, run);
    const auto simbody = simulateSimbody(model, run);
    const auto fine = simulateForward(model, run, kFiner);
    const int contact = motion.first_contact, end = run.samples();
    const int after = std::min(end, contact + static_cast<int>(kAfter / kInterval));
    Agreement agreement;
    agreement.reach = motion.reach;
    agreement.before = calcDifference(motion.relative, simbody, 0, contact);
    agreement.after = calcDifference(motion.relative, simbody, contact, after);
    agreement.fine_before = calcDifference(fine.relative, simbody, 0, contact);
    agreement.fine_after = calcDifference(fine.relative, simbody, contact, after);
    agreement.whole = calcDifference(motion.relative, simbody, 0, end);
    const auto a = calcEnvelope(motion.relative), b = calcEnvelope(simbody);
    agreement.envelope = (a - b).norm() / b.norm();
    return agreement;
}

/// Drawn again where there is no run.
std::pair<MountModel, Run> drawModelAndRun(hidden::Random& random) {
    for (int attempt = 0; attempt < 20; ++attempt) {
        const MountModel model = drawExtendedDevice(random);
        if (const auto run = findRun(model, random)) return {model, *run};
    }
    FAIL("no device of twenty has a run that touches a stop");
    return {};
}

}  // namespace

TEST_CASE("the forward model and Simbody agree run by run, with every law in play") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    hidden::Random random(seed);
    const auto [model, run] = drawModelAndRun(random);
    const auto agreement = compareOn(model, run);
    REQUIRE(agreement.reach > 1);
    CHECK(agreement.before < 1e-2);
    CHECK(agreement.after < 2e-2);
    CHECK(agreement.fine_before < 1e-4);
    CHECK(agreement.fine_after < 1e-3);
    CHECK(agreement.envelope < 0.1);
}

// What the documentation states: many devices, one line each.
TEST_CASE("agreement of the forward model with Simbody over many devices", "[.agreement]") {
    for (unsigned seed = 1; seed <= 30; ++seed) {
        hidden::Random random(seed);
        const auto [model, run] = drawModelAndRun(random);
        const auto agreement = compareOn(model, run);
        std::printf("%3u  reach %.2f  before %.2e  after %.2e  whole %.2e  envelope %.2e  finer: %.2e %.2e\n", seed,
                    agreement.reach, agreement.before, agreement.after, agreement.whole, agreement.envelope,
                    agreement.fine_before, agreement.fine_after);
        std::fflush(stdout);
        CHECK(agreement.fine_before < 1e-3);
    }
}
