#include "identify/fit/remainder.hpp"

#include <Eigen/LU>
#include <cmath>

#include "identify/fit/solver.hpp"

namespace wems::identify {

std::vector<RunRemainder> calcRemainders(const Solver& solver) {
    const NormalEquations& equations = solver.equations();
    const Eigen::VectorXd all = equations.makeCoefficients(solver.model());
    Eigen::VectorXd without_mount = all;
    without_mount.tail(all.size() - equations.layout().stiffness(0)).setZero();
    std::vector<RunRemainder> runs;
    for (std::size_t r = 0; r < solver.runCount(); ++r) {
        const TestFunction& test_function = equations.runs()[r].test_function;
        const Matrix6d unwhiten = equations.whitening(r).inverse();
        const auto apply = [&](const Eigen::VectorXd& coefficients) -> Eigen::Matrix<double, 6, Eigen::Dynamic> {
            const RowMatrix white = equations.apply(r, coefficients);
            return unwhiten *
                   Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>>(white.data(), 6, white.size() / 6);
        };
        RunRemainder run;
        const double interval = test_function.interval();
        run.start = solver.motions()[r].time.front() + test_function.half() * interval;
        run.interval = test_function.stride() * interval;
        run.overlap = 2 * test_function.half() * interval;
        run.demanded = apply(without_mount);
        run.unexplained = apply(all);
        runs.push_back(std::move(run));
    }
    return runs;
}

double calcUnexplainedFraction(const std::vector<RunRemainder>& runs, const MountModel& model) {
    double arm_squares = 0;
    for (const auto& connection : model.connections) arm_squares += connection.position.squaredNorm();
    arm_squares /= static_cast<double>(model.connections.size());
    if (!(arm_squares > 0)) arm_squares = 1;
    const auto calcSquares = [&](const Eigen::Matrix<double, 6, Eigen::Dynamic>& wrench) {
        return wrench.topRows<3>().squaredNorm() + wrench.bottomRows<3>().squaredNorm() / arm_squares;
    };
    double unexplained = 0, demanded = 0;
    for (const RunRemainder& run : runs) {
        unexplained += calcSquares(run.unexplained);
        demanded += calcSquares(run.demanded);
    }
    return demanded > 0 ? std::sqrt(unexplained / demanded) : 0.0;
}

Eigen::VectorXd calcAutocorrelation(const Eigen::VectorXd& series, int lags) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(lags + 1);
    const double power = series.squaredNorm();
    if (!(power > 0)) return result;
    for (Eigen::Index lag = 0; lag <= lags && lag < series.size(); ++lag)
        result[lag] = series.head(series.size() - lag).dot(series.tail(series.size() - lag)) / power;
    return result;
}

double calcAutocorrelationLimit(const Eigen::VectorXd& before, Eigen::Index count) {
    const double squares = before.size() > 1 ? before.tail(before.size() - 1).squaredNorm() : 0.0;
    return 1.96 * std::sqrt((1 + 2 * squares) / static_cast<double>(count));
}

}  // namespace wems::identify
