// The error of a free simulation, of the model that made the recording: nothing but what the recording leaves out.
#include <catch2/catch.hpp>

#include "identify/forward/compare.hpp"
#include "identify/updating/free_runs.hpp"
#include "models/excitation.hpp"
#include "tests/forward/forward_fixture.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double lowest = 8, highest = 40;  // Hz

MountModel makeDevice() {
    MountModel model = test::makeCross();
    for (Connection& connection : model.connections) {
        for (AxisLaw& law : connection.axis) law.damping = 2e-3 * law.stiffness;
        connection.axis[2].stops = {{Side::positive, 4e-4, 8e5, 0.0}, {Side::negative, 5e-4, 8e5, 0.0}};
    }
    return model;
}

void addRows(Recording& recording, Part part, const MountModel& model, const Eigen::MatrixXd& rows,
             Derivative derivative) {
    Eigen::Index row = 0;
    for (const Connection& connection : model.connections) {
        for (int axis = 0; axis < 3; ++axis, ++row) {
            const Eigen::RowVectorXd values = rows.row(row);
            Channel channel;
            channel.name = formatChannelName({part, connection.name, axis, derivative});
            channel.values.assign(values.begin(), values.end());
            recording.channels.push_back(std::move(channel));
        }
    }
}

struct Shaken {
    MarkerMotion markers;
    Recording recording;  ///< times and base acceleration
    double largest = 0;   ///< m, relative displacement
};

/// The device on a table that sweeps (m/s²), or on its bracket with a load that does (N), simulated with steps far
/// finer than those of the comparison.
Shaken shake(const MountModel& model, double level, double rate) {
    const auto sweep = makeLogarithmicSweep(lowest, highest, 40, {0.2, 0.2});
    TimeGrid grid = test::makeGrid(1 / rate, static_cast<int>((sweep->duration() + 1) * rate), 16);
    std::vector<double> times;
    Eigen::Matrix3Xd drives(3, grid.halfSteps());
    for (int half = 0; half < grid.halfSteps(); ++half) {
        times.push_back(grid.halfStepTime(half));
        const double value = times.back() < sweep->duration() ? level * sweep->value(times.back()) : 0.0;
        drives.col(half) = value * Eigen::Vector3d(0.3, 0.2, 1);
    }
    const bool loaded = !model.bracket.empty();
    const Drive drive = loaded ? Drive::makeLoad(times, drives, {}, grid) : Drive::makeLoad(times, {}, drives, grid);
    const ForwardModel forward(model);
    const Simulation simulation = forward.simulate(drive, Keep::states);
    Shaken shaken;
    shaken.markers = forward.calcMarkers(simulation, drive);
    shaken.largest = simulation.q.cwiseAbs().maxCoeff();
    shaken.recording.file = "shaken.csv";
    shaken.recording.time = test::makeTimes(grid);
    for (int axis = 0; axis < 3; ++axis) {
        Channel channel;
        channel.name = loaded ? formatChannelName({Part::load, {}, axis, Derivative::force})
                              : formatChannelName({Part::base, {}, axis, Derivative::acceleration});
        for (int k = 0; k < grid.samples; ++k) channel.values.push_back(drives(axis, grid.halfStepOf(k)));
        shaken.recording.channels.push_back(std::move(channel));
    }
    return shaken;
}

double calcError(const MountModel& model, const Recording& recording) {
    const RunMotion run = estimateMotion(recording, model);
    return calcSimulationError(model, prepareRun(run, model, lowest)).value();
}

/// As a diagnosis compares, which estimated the motion with another model.
double calcErrorOfVerdict(const MountModel& model, const Recording& recording, const MountModel& believed) {
    const updating::TestProblem problem({recording}, {}, believed);
    return updating::FreeRuns(problem, 0, 1).calcError(model).error;
}

}  // namespace

TEST_CASE("from accelerations alone on a table the true model's error is below a thousandth, stops or not") {
    MountModel model = makeDevice();
    for (const double level : {3.0, 20.0}) {
        for (const double rate : {1000.0, 4000.0}) {
            const Shaken shaken = shake(model, level, rate);
            CAPTURE(level, rate, shaken.largest);
            CHECK((shaken.largest > 5e-4) == (level > 10));
            Recording of_base = shaken.recording;
            addRows(of_base, Part::mobile, model, shaken.markers.mobile_acceleration, Derivative::acceleration);
            CHECK(calcError(model, of_base) < 1e-3);
            Recording of_table = of_base;
            of_table.channels.erase(of_table.channels.begin(), of_table.channels.begin() + 3);
            addRows(of_table, Part::fixed, model, shaken.markers.fixed_acceleration, Derivative::acceleration);
            // The table's own motion is not known below 0.9 of the lowest frequency, where the sweep's start spreads.
            CHECK(calcError(model, of_table) < 5e-3);
            model.body.mass *= 1.02;
            CHECK(calcError(model, of_base) > 5e-3);
            model.body.mass /= 1.02;
        }
    }
}

// The sag is a part of the measured motion, that of the believed model; what is compared counts from rest. A short
// recording shows what else a high pass leaves at the ends.
TEST_CASE("the sag under gravity leaves nothing where accelerations alone were recorded, whatever was believed") {
    MountModel model = makeDevice(), believed = makeDevice();
    for (MountModel* each : {&model, &believed}) {
        each->gravity = {0, 0, -9.81};
        for (Connection& connection : each->connections) connection.axis[2].stops.clear();
    }
    for (AxisLaw& law : believed.connections[2].axis) law.stiffness *= 1.4;
    for (const double level : {0.3, 3.0}) {
        const Shaken shaken = shake(model, level, 1000);
        CAPTURE(level, shaken.largest);
        Recording accelerations = shaken.recording;
        addRows(accelerations, Part::mobile, model, shaken.markers.mobile_acceleration, Derivative::acceleration);
        CHECK(calcErrorOfVerdict(model, accelerations, believed) < 1e-3);
        CHECK(calcErrorOfVerdict(believed, accelerations, believed) > 1e-2);
    }
}

TEST_CASE("the sag under gravity leaves nothing where displacements were recorded, of all axes or not") {
    MountModel model = makeDevice();
    model.bracket = test::makeBracketModes();
    model.gravity = {0, 0, -9.81};
    for (Connection& connection : model.connections) connection.axis[2].stops.clear();
    const Shaken shaken = shake(model, 100, 1000);
    CAPTURE(shaken.largest);
    Recording recording = shaken.recording;
    addRows(recording, Part::mobile, model, shaken.markers.mobile_displacement, Derivative::displacement);
    addRows(recording, Part::fixed, model, shaken.markers.fixed_displacement, Derivative::displacement);
    CHECK(calcErrorOfVerdict(model, recording, model) < 1e-3);
    // A connection without all three axes is that of the rigid motion.
    recording.channels.erase(recording.channels.begin() + 3);
    CHECK(calcErrorOfVerdict(model, recording, model) < 1e-3);
}
