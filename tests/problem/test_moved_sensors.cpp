// Where sensors sit decides what their noise makes of the motion.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "identify/motion/noise_estimate.hpp"
#include "identify/updating/test_problem.hpp"
#include "models/common/units.hpp"
#include "tests/hidden/hidden_recording.hpp"
#include "tests/problem/random_drive.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

TEST_CASE("Sensors that errors move are where the layout then has them") {
    MountModel model;
    model.connections.resize(1);
    model.connections[0].name = "1";
    Recording recording;
    for (const char* name : {"mobile.1.x", "mobile.1.z"}) recording.channels.push_back({name, "m", {0, 0}});
    recording.time = {0, 1};
    const SensorLayout layout = makeSensorLayout({recording}, model);
    SensorErrors errors(layout);
    errors.place.col(0) << 1e-3, 2e-3, 3e-3;
    errors.rotation.col(0) << 0, kPi / 2, 0;
    const SensorLayout moved = moveSensors(layout, errors, recording);
    // Of a triad without y the directions are taken off with the motion: a sensor that is turned by R shows R v, the
    // component of v along Rᵀ e.
    const Eigen::Vector3d seen[] = {Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitX()};
    for (std::size_t c = 0; c < 2; ++c) {
        CHECK((moved.channels[c].position - layout.channels[c].position - Eigen::Vector3d(1e-3, 2e-3, 3e-3)).norm() <
              1e-15);
        CHECK((moved.channels[c].direction - seen[c]).norm() < 1e-12);
    }
}

// The misfit has the slope 2 (b − s) only where the covariance follows the places: with that of the believed places
// what is left over had twice the noise's slope s itself.
TEST_CASE("The misfit's slope along a sensor's place is that of its column, less the noise's") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    hidden::Random random(seed);
    auto hidden = drawRandomDrive("bracket", hidden::Sensors::accelerations, random);
    // What is left of a column is over the noise, the slope of the noise is not.
    hidden.acceleration_noise *= 30;
    // Contact has noise of its own.
    for (MountModel* model : {&hidden.base, &hidden.truth})
        for (Connection& connection : model->connections)
            for (AxisLaw& law : connection.axis) law.stops.clear();
    const TestProblem problem({hidden::recordRun(hidden, 0, seed)}, {}, hidden.base);
    const TestView view = problem.view(problem.believedPoint(), {});
    const auto calcSquares = [&](const Eigen::VectorXd& estimate) {
        const TestMisfit misfit = problem.misfit(problem.pointAt(estimate, {}));
        return misfit.identification[indexOf(Block::mount)].chi_squared +
               misfit.identification[indexOf(Block::bracket)].chi_squared;
    };
    std::vector<double> left;
    double slopes = 0;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < problem.table().size(); ++i)
        if (problem.table()[i].kind == UnknownKind::station_place) places.push_back(i);
    std::shuffle(places.begin(), places.end(), random);
    places.resize(8);  // for time
    for (const std::size_t i : places) {
        const auto row = static_cast<Eigen::Index>(i);
        double told = 0, slope = 0;
        for (const Block block : {Block::mount, Block::bracket}) {
            const BlockInformation& own = view.identification[indexOf(block)];
            slope += 2 * own.noise_slopes.row(row).sum();
            told += 2 * own.b[row] - 2 * own.noise_slopes.row(row).sum();
        }
        Eigen::VectorXd ahead = Eigen::VectorXd::Zero(problem.deviations().size());
        ahead[row] = 1e-5;
        left.push_back(std::abs((calcSquares(ahead) - calcSquares(-ahead)) / (2 * ahead[row]) - told));
        slopes += slope * slope;
    }
    const double typical = std::sqrt(slopes / static_cast<double>(left.size()));
    CAPTURE(left, typical);
    // The median: where a low pass is chosen anew, the misfit jumps.
    CHECK(median(left) < 0.2 * typical);
}
