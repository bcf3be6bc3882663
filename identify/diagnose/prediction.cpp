#include "identify/diagnose/prediction.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/parallel.hpp"

namespace wems::identify {
namespace {

constexpr std::size_t kDraws = 20;
constexpr std::size_t kInside = 19;  // of the draws, by size: 95 %

/// Square root of a covariance that may be singular.
Eigen::MatrixXd calcRoot(const Eigen::MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// What gains and directions of the displacement channels, as far as they are known, add to a relative displacement.
double calcSensorVariance(const TestProblem& problem, const Selection& selection) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < problem.table().size(); ++i) {
        const Unknown& row = problem.table()[i];
        const auto index = static_cast<Eigen::Index>(i);
        const bool gain = row.kind == UnknownKind::channel_gain;
        if (!gain && row.kind != UnknownKind::triax_rotation) continue;
        const double off = selection.posterior.mean[index];
        sum += off * off + selection.posterior.covariance(index, index);
        if (gain) ++count;
    }
    return count > 0 ? sum / count : 0;
}

}  // namespace

std::vector<FreeRun> prepareFreeRuns(const std::vector<Recording>& recordings,
                                     const std::vector<const RunMotion*>& motions, const MountModel& model) {
    std::vector<FreeRun> runs;
    for (std::size_t r = 0; r < recordings.size(); ++r)
        runs.push_back({motions[r], calcMeasuredRelative(recordings[r], *motions[r], model)});
    return runs;
}

double calcPredictionBand(const TestProblem& problem, const Selection& selection, const std::vector<FreeRun>& runs,
                          double noise_floor, unsigned seed) {
    std::vector<Eigen::MatrixXd> reference;
    double signal = 0;
    const MountModel best = problem.cleanModel(selection.point);
    try {
        for (const FreeRun& run : runs) {
            reference.push_back(calcFreeResidual(run, best));
            signal += run.measured.squaredNorm();
        }
    } catch (const SimulationDiverged&) {
        return std::numeric_limits<double>::infinity();
    }
    const Eigen::MatrixXd root = calcRoot(selection.posterior.covariance);
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::vector<Eigen::VectorXd> draws;
    for (std::size_t d = 0; d < kDraws; ++d) {
        Eigen::VectorXd z(root.cols());
        for (double& value : z) value = normal(generator);
        draws.push_back(selection.posterior.mean + root * z);
    }
    std::vector<double> errors(kDraws);
    runParallel(kDraws, [&](std::size_t d) {
        try {
            const MountModel model = problem.cleanModel(problem.pointAt(draws[d], selection.set));
            double difference = 0;
            for (std::size_t r = 0; r < runs.size(); ++r)
                difference += (calcFreeResidual(runs[r], model) - reference[r]).squaredNorm();
            errors[d] = difference / signal;
        } catch (const SimulationDiverged&) {
            errors[d] = std::numeric_limits<double>::infinity();
        }
    });
    std::sort(errors.begin(), errors.end());
    return std::sqrt(errors[kInside - 1] + noise_floor * noise_floor + calcSensorVariance(problem, selection));
}

}  // namespace wems::identify
