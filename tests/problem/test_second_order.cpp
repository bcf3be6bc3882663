#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>

#include "identify/problem/lineariser.hpp"
#include "identify/updating/test_problem.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/problem/swept_motion.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// Accelerations of all connections, in ground axes.
Recording recordAccelerations(const MountModel& model, const SweptMotion& motion, double noise,
                              std::mt19937_64& random) {
    std::vector<std::pair<std::string, std::string>> stations;
    for (const Connection& connection : model.connections) stations.emplace_back(connection.name, "xyz");
    const auto read = [&](std::size_t i, double t) {
        return motion.findAcceleration(t, model.connections[i].position);
    };
    return recordStations(stations, "a", read, noise, random);
}

bool endsWith(const std::string& name, const std::string& end) {
    return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

/// An error that all sensors of a part share: a unit of each row whose name ends so.
Eigen::VectorXd shareError(const TestProblem& problem, const std::string& end, const std::string& part = "mobile") {
    Eigen::VectorXd shared = Eigen::VectorXd::Zero(problem.deviations().size());
    for (std::size_t i = 0; i < problem.table().size(); ++i) {
        const std::string& name = problem.table()[i].name;
        if (name.rfind(part + ".", 0) == 0 && endsWith(name, end)) shared[static_cast<Eigen::Index>(i)] = 1;
    }
    return shared;
}

/// Displacements of both parts as accelerometers would have them, by differences of fourth order: 1e-5 of them at 100
/// Hz. @param noise m/s²
Recording differentiate(const Recording& displacements, double noise, std::mt19937_64& random) {
    std::normal_distribution<double> normal(0, noise);
    const double h = displacements.sampleInterval();
    Recording result;
    result.time.assign(displacements.time.begin() + 2, displacements.time.end() - 2);
    for (const Channel& channel : displacements.channels) {
        Channel own = channel;
        const bool load = channel.name.rfind("load.", 0) == 0;
        const auto& x = channel.values;
        own.values.assign(x.begin() + 2, x.end() - 2);
        if (!load) {
            own.name.insert(own.name.size() - 1, "a");
            own.unit = "m/s^2";
            for (std::size_t k = 2; k + 2 < x.size(); ++k)
                own.values[k - 2] =
                    (16 * (x[k - 1] + x[k + 1]) - x[k - 2] - x[k + 2] - 30 * x[k]) / (12 * h * h) + normal(random);
        }
        result.channels.push_back(std::move(own));
    }
    return result;
}

/// How far the columns of an error that sensors share are from differences of what the mount's equations leave, both
/// whitened as the believed point has it: |difference|² / |column|² above a frequency (Hz).
double compareColumns(const TestProblem& problem, const Eigen::VectorXd& shared, double from = 0) {
    const TestPoint here = problem.believedPoint();
    const PointEquations base = problem.misfit(here).equations;
    Lineariser& at = *base.at.front();
    at.prepareColumns();
    SensorColumns sensors(base.runs->front(), problem.layout(), at.run(), at.spectra(), at.motionNoise(),
                          problem.table(), {});
    sensors.addSecondOrder({at.makeTurningWrench(Part::mobile), at.makeTurningWrench(Part::fixed)});
    Eigen::MatrixXcd column = Eigen::MatrixXcd::Zero(12, at.spectra().binCount());
    for (std::size_t i = 0; i < problem.table().size(); ++i)
        if (shared[static_cast<Eigen::Index>(i)] != 0) column += at.calcMotionColumn(sensors.calcEffect(i));
    const double step = 3 / std::sqrt(2 * column.squaredNorm());
    const auto leave = [&](double part) {
        const PointEquations moved = problem.misfit(problem.pointAt(part * shared, {})).equations;
        const Lineariser& there = *moved.at.front();
        Eigen::MatrixXcd left = there.residual();
        for (Eigen::Index b = 0; b < left.cols(); ++b)
            left.col(b) = at.noise().whitener(b) *
                          there.noise().whitener(b).triangularView<Eigen::Lower>().solve(left.col(b)).eval();
        return left;
    };
    const Eigen::MatrixXcd difference = (leave(step) - leave(-step)) / (2 * step);
    Eigen::Index first = 0;
    while (at.spectra().frequency(first) < from) ++first;
    const auto count = [&](const Eigen::MatrixXcd& rows) {
        return rows.topRightCorner(6, rows.cols() - first).squaredNorm();
    };
    return count(difference - column) / count(column);
}

}  // namespace

// What all sensors share moves all channels as a rigid motion does, so that only what turns with the part shows it:
// rotations of 0.01 rad times accelerations. A column to first order in the motion had a tenth of the curvature for AC
// coupling.
TEST_CASE("The sensors' quadratic follows shared errors as far as the part turns", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel model = identify::testing::makeRandomDevice(random);
    model.bracket.clear();
    const SweptMotion motion(random);
    const TestProblem problem({recordAccelerations(model, motion, 1e-3, random)}, {}, model);
    const TestView view = problem.view(problem.believedPoint());
    const std::size_t sensors = indexOf(Block::mobile_sensors);
    const BlockInformation& block = view.identification[sensors];
    for (const char* end : {".corner", ".gain", ".rx", ".rz"}) {
        const Eigen::VectorXd shared = shareError(problem, end);
        const double A = shared.dot(block.A * shared), step = 10 / std::sqrt(A);
        CAPTURE(end, A, step);
        REQUIRE(A > 0);
        const auto misfitAt = [&](double error) {
            return problem.misfit(problem.pointAt(error * shared, {})).identification[sensors].chi_squared;
        };
        const double ahead = misfitAt(step), here = misfitAt(0), behind = misfitAt(-step);
        CAPTURE(here / block.count);
        CHECK(ahead + behind - 2 * here == Approx(2 * A * step * step).epsilon(0.1));
    }
}

namespace {

/// The device as it is driven, by displacements or, sampled more densely, by accelerations.
Recording recordDevice(const MountModel& model, double size, bool accelerations, std::mt19937_64& random,
                       double noise = 1e-3) {
    identify::testing::RunPlan plan;
    plan.duration = 8;
    plan.force = size * Eigen::Vector3d(20, 30, 120);
    if (!accelerations) return recordRun(model, plan, random);
    plan.rate = 4000;
    plan.noise = 0;
    return differentiate(recordRun(model, plan, random), noise, random);
}

}  // namespace

// Clear of stops nothing but what turns has anything above the sweep, which ends at 50 Hz. There columns of first order
// of a gain or of AC coupling err by up to four and up to 26 times themselves. What second order leaves is of third
// order; of a delay and of AC coupling also of the laws' damping and of motions below the sweep, which columns follow
// in part.
TEST_CASE("Above the sweep columns of shared errors are differences of what the equations leave", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel model = identify::testing::makeRandomDevice(random);
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) law.stops.clear();
    const TestProblem problem({recordDevice(model, 0.1, true, random, 1e-5)}, {}, model);
    const std::string part = GENERATE("mobile", "fixed");
    CAPTURE(part);
    for (const std::string end : {".gain", ".delay", ".rx", ".rz", ".position.x", ".position.z", ".corner"}) {
        const Eigen::VectorXd shared = shareError(problem, end, part);
        REQUIRE(!shared.isZero(0.0));
        CAPTURE(end);
        CHECK(compareColumns(problem, shared, 60) < (end == ".delay" || end == ".corner" ? 0.6 : 0.1));
    }
}

// Of contact, where slow motion follows too.
TEST_CASE("Columns of shared errors are differences of what the equations leave, in contact", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    const bool accelerations = GENERATE(false, true);
    CAPTURE(accelerations);
    const TestProblem problem({recordDevice(model, 1, accelerations, random)}, {}, model);
    for (const std::string end : {".gain", ".delay", ".rx", ".rz", ".position.x", ".position.z", ".corner"}) {
        const Eigen::VectorXd shared = shareError(problem, end);
        if (shared.isZero(0.0)) continue;
        CAPTURE(end);
        CHECK(compareColumns(problem, shared) < 0.01);
    }
}
