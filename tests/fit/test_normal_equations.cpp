// Inner products and slopes of the regression against the columns themselves and against differences.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "identify/fit/normal_equations.hpp"
#include "identify/fit/parameter_set.hpp"
#include "identify/motion/motion.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Two short sweeps of the shipped device into its stops, without noise.
struct Problem {
    Problem() : equations(makeRuns(model)) {
        std::vector<StopTerm> stops;
        for (int axis = 0; axis < 12; ++axis) {
            const AxisLaw& law = model.connections[axis / 3].axis[axis % 3];
            for (int s = 0; s < static_cast<int>(law.stops.size()); ++s)
                if (reaches(axis, law.stops[s])) stops.push_back({axis / 3, axis % 3, s});
        }
        equations.setStops(model, stops);
    }

    static std::vector<RunEquations> makeRuns(const MountModel& model) {
        std::vector<RunEquations> runs;
        for (const Eigen::Vector3d& force : {Eigen::Vector3d(60, 0, 500), Eigen::Vector3d(0, 80, 400)}) {
            test::SweepSettings settings;
            settings.force = force;
            settings.from = 28;
            settings.to = 34;
            settings.octaves_per_minute = 30;
            const auto motion = estimateMotion(test::record(test::simulateSweep(model, settings), {0, 0}, 1), model);
            runs.push_back(makeEquations(motion, model, TestFunction(4, motion.interval), true));
        }
        return runs;
    }

    bool reaches(int axis, const Stop& stop) const {
        bool reached = false;
        for (const RunEquations& run : equations.runs())
            for (const double q : run.axes[axis].q)
                reached |= (stop.side == Side::positive ? q : -q) > 1.05 * stop.clearance;
        return reached;
    }

    /// All columns of a run, one by one.
    MatrixXd columns(std::size_t run) const {
        return equations.apply(run, MatrixXd::Identity(equations.gram().cols(), equations.gram().cols()));
    }

    /// What the model leaves of a run.
    VectorXd residual(std::size_t run, const MountModel& other) {
        equations.updateStops(other);
        const MatrixXd all = equations.apply(run, equations.makeCoefficients(other));
        return all.col(0);
    }

    MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    NormalEquations equations;
};

}  // namespace

TEST_CASE("NormalEquations: inner products are those of the columns, whitened run by run") {
    Problem problem;
    REQUIRE(problem.equations.stops().size() >= 2);
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::vector<Matrix6d> transforms;
    for (int run = 0; run < 2; ++run)
        transforms.push_back(Matrix6d::NullaryExpr([&] { return std::uniform_real_distribution<>(-1, 1)(random); }));
    const std::vector<MatrixXd> before{problem.columns(0), problem.columns(1)};
    const auto stops = problem.equations.stops();
    problem.equations.whiten(transforms);
    problem.equations.setStops(problem.model, stops);
    MatrixXd sum = MatrixXd::Zero(problem.equations.gram().rows(), problem.equations.gram().cols());
    for (std::size_t run = 0; run < 2; ++run) {
        const MatrixXd white = problem.columns(run);
        for (Eigen::Index row = 0; row < white.rows(); row += 6 * 50) {
            const MatrixXd expected = transforms[run] * before[run].middleRows(row, 6);
            CHECK((white.middleRows(row, 6) - expected).norm() <= 1e-12 * expected.norm());
        }
        sum += white.transpose() * white;
    }
    // Round-off of sums of some thousand products.
    for (Eigen::Index i = 0; i < sum.rows(); ++i)
        for (Eigen::Index j = 0; j < sum.cols(); ++j)
            CHECK(std::abs(problem.equations.gram()(i, j) - sum(i, j)) <= 1e-10 * std::sqrt(sum(i, i) * sum(j, j)));
}

TEST_CASE("NormalEquations: the Jacobian is the slope of what a model leaves") {
    Problem problem;
    const auto parameters = makeParameters(problem.model, {"body.center_of_gravity", "body.inertia"});
    const std::vector<MatrixXd> columns{problem.columns(0), problem.columns(1)};
    const MatrixXd jacobian = problem.equations.makeJacobian(problem.model, parameters);
    REQUIRE(jacobian.cols() == static_cast<Eigen::Index>(parameters.size()));
    int moving = 0;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        const bool clearance = parameters[p].kind == ParameterKind::clearance;
        const double step = clearance ? 1e-8 : 1e-4 * calcScale(problem.model, parameters[p]);
        MountModel more = problem.model, less = problem.model;
        const double value = getParameter(problem.model, parameters[p].name);
        setParameter(more, parameters[p].name, value + step);
        setParameter(less, parameters[p].name, value - step);
        for (std::size_t run = 0; run < 2; ++run) {
            const VectorXd slope = (problem.residual(run, more) - problem.residual(run, less)) / (2 * step);
            const VectorXd given = columns[run] * jacobian.col(static_cast<Eigen::Index>(p));
            CAPTURE(parameters[p].name, run, slope.norm(), given.norm());
            // Differences of what is linear: round-off. A sample crosses its clearance within the step of 10 nm only
            // where the mount moves a clearance past it within some thousand samples: a part in a hundred.
            CHECK((slope - given).norm() <= (clearance ? 0.02 : 1e-6) * slope.norm() + 1e-12 * columns[run].norm());
            moving += clearance && slope.norm() > 0;
        }
    }
    CHECK(moving >= 2);
}

}  // namespace wems::identify
