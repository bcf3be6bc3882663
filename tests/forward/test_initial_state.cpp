// Recordings that begin in motion: free decay from a pulled position, and vibration that was running before.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "identify/forward/compare.hpp"
#include "identify/forward/initial_state.hpp"
#include "identify/forward/relative_displacement.hpp"
#include "models/bryant.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kInterval = 1e-3;  // s

MountModel makeDamped(bool bracket) {
    MountModel model = test::makeCross();
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.damping = 30;
    if (bracket) model.bracket = test::makeBracketModes();
    return model;
}

/// What a laboratory records of a simulation: both ends of every connection.
Recording record(const ForwardModel& forward, const Simulation& simulation, const Drive& drive, bool accelerations,
                 double noise, unsigned seed) {
    const MarkerMotion markers = forward.calcMarkers(simulation, drive);
    Recording recording;
    recording.file = "decay.csv";
    for (Eigen::Index k = 0; k < simulation.q.cols(); ++k)
        recording.time.push_back(drive.grid().sampleTime(simulation.first_sample + static_cast<int>(k)));
    std::mt19937 generator(seed);
    std::normal_distribution<double> draw(0, 1);
    const auto add = [&](Part part, Derivative derivative, const Eigen::MatrixXd& values, double sigma) {
        for (Eigen::Index i = 0; i < values.rows(); ++i) {
            Channel channel;
            const Connection& connection = forward.model().connections[i / 3];
            channel.name = formatChannelName({part, connection.name, static_cast<int>(i % 3), derivative});
            for (Eigen::Index k = 0; k < values.cols(); ++k)
                channel.values.push_back(values(i, k) + sigma * draw(generator));
            recording.channels.push_back(channel);
        }
    };
    add(Part::mobile, Derivative::displacement, markers.mobile_displacement, noise);
    add(Part::fixed, Derivative::displacement, markers.fixed_displacement, noise);
    if (!accelerations) return recording;
    const double acceleration_noise = 1e4 * noise;  // m/s² for each m, as good piezoelectric sensors beside lasers
    add(Part::mobile, Derivative::acceleration, markers.mobile_acceleration, acceleration_noise);
    add(Part::fixed, Derivative::acceleration, markers.fixed_acceleration, acceleration_noise);
    return recording;
}

}  // namespace

TEST_CASE("a free decay from a pulled position is simulated from its start") {
    const bool bracket = GENERATE(false, true);
    const bool accelerations = GENERATE(false, true);
    const double noise = GENERATE(0.0, 1e-6);  // m
    CAPTURE(bracket, accelerations, noise);
    const MountModel model = makeDamped(bracket);
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(kInterval, 1500, 4);
    const Drive drive = Drive::makeFree(grid);
    ForwardState pulled = forward.restState();
    pulled.mobile.p_GM = {0.5e-3, -0.3e-3, 1e-3};
    pulled.mobile.R_GM = rotationFromVector({4e-3, -2e-3, 1e-3});
    const Simulation truth = forward.simulate(drive, pulled, 0, grid.samples, Keep::states);
    const RunMotion run = estimateMotion(record(forward, truth, drive, accelerations, noise, 3), model);
    PreparedRun prepared{drive, calcRelativeDisplacement(run, model), findStartMotion(run, model, drive)};
    REQUIRE(prepared.start);
    const double started = calcSimulationError(model, prepared).value();
    prepared.start.reset();
    const double rested = calcSimulationError(model, prepared).value();
    CHECK(rested > 0.9);  // from rest nothing moves
    // Without noise what the polynomial over the first samples leaves; with 1 µm in 1 mm, and velocities from the
    // displacements alone, some percent of the amplitude.
    CHECK(started < (accelerations ? 5e-3 : noise > 0 ? 5e-2 : 2e-2));
}

TEST_CASE("vibration that was running before the recording starts from its own motion") {
    const MountModel model = makeDamped(true);
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(kInterval, 2500, 4);
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, grid);
    const Simulation truth = forward.simulate(drive, Keep::states);
    // The recording begins in the middle.
    const int first = 1200;
    const Recording whole = record(forward, truth, drive, true, 1e-6, 5);
    Recording late = whole;
    late.time.assign(whole.time.begin() + first, whole.time.end());
    for (Channel& channel : late.channels) channel.values.erase(channel.values.begin(), channel.values.begin() + first);
    const RunMotion run = estimateMotion(late, model);
    TimeGrid late_grid = grid;
    late_grid.start = late.time.front();
    late_grid.samples = grid.samples - first;
    const Drive late_drive = Drive::makeLoad(test::makeTimes(grid), test::makeLoad(grid, 300), {}, late_grid);
    PreparedRun prepared{late_drive, calcRelativeDisplacement(run, model), findStartMotion(run, model, late_drive)};
    REQUIRE(prepared.start);
    const double started = calcSimulationError(model, prepared).value();
    prepared.start.reset();
    const double rested = calcSimulationError(model, prepared).value();
    CHECK(started < 2e-2);
    CHECK(rested > 5 * started);
}

TEST_CASE("a run that begins at rest starts from rest, also where a sensor's zero is off") {
    const MountModel model = makeDamped(false);
    const ForwardModel forward(model);
    const TimeGrid grid = test::makeGrid(kInterval, 1500, 4);
    Eigen::Matrix3Xd base = test::makeLoad(grid, 5);
    base.leftCols(100).setZero();
    const Drive drive = Drive::makeLoad(test::makeTimes(grid), {}, base, grid);
    const Simulation truth = forward.simulate(drive, Keep::states);
    Recording recording = record(forward, truth, drive, false, 1e-6, 4);
    CHECK(!findStartMotion(estimateMotion(recording, model), model, drive));
    for (Channel& channel : recording.channels)
        if (channel.name.back() == 'z' && channel.name[0] == 'm')
            for (double& value : channel.values) value += 2e-4;  // m
    CHECK(!findStartMotion(estimateMotion(recording, model), model, drive));
}

TEST_CASE("bracket modes of the start move the fixed part as it was measured") {
    const MountModel model = makeDamped(true);
    const ForwardModel forward(model);
    const Drive drive = Drive::makeFree(test::makeGrid(kInterval, 2));
    ForwardState state = forward.restState();
    state.eta = Eigen::Vector3d(2e-3, -1e-3, 5e-4);
    state.eta_dot = Eigen::Vector3d(0.2, 0.1, -0.05);
    StartMotion start;
    start.mobile = state.mobile;
    start.fixed = Bracket(model.bracket).calcMotion(state.eta, state.eta_dot);
    const ForwardState found = makeState(forward, start, drive);
    CHECK((found.eta - state.eta).norm() < 1e-12);
    CHECK((found.eta_dot - state.eta_dot).norm() < 1e-12);
}
