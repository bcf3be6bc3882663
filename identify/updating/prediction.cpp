#include "identify/updating/prediction.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/parallel.hpp"
#include "models/error.hpp"

namespace wems::identify::updating {
namespace {

constexpr std::size_t kDraws = 20;
constexpr std::size_t kInside = 19;  // of the draws, by size: 95 %

/// Square root of a covariance that may be singular.
Eigen::MatrixXd calcRoot(const Eigen::MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

double calcPredictionBand(const TestProblem& problem, const HypothesisSet& set, const TestPoint& point,
                          const Posterior& posterior, const std::vector<FreeRun>& runs, std::size_t first,
                          double noise_floor, unsigned seed) {
    std::vector<Eigen::MatrixXd> reference;
    double signal = 0;
    const MountModel best = problem.cleanModel(point);
    try {
        for (const FreeRun& run : runs) {
            reference.push_back(calcFreeResidual(run, best));
            signal += run.measured.squaredNorm();
        }
    } catch (const SimulationDiverged&) {
        return std::numeric_limits<double>::infinity();
    }
    const Eigen::MatrixXd root = calcRoot(posterior.covariance);
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::vector<Eigen::VectorXd> draws;
    for (std::size_t d = 0; d < kDraws; ++d) {
        Eigen::VectorXd z(root.cols());
        for (double& value : z) value = normal(generator);
        draws.push_back(problem.estimateOf(point) + root * z);
    }
    std::vector<double> errors(kDraws);
    runParallel(kDraws, [&](std::size_t d) {
        try {
            const TestPoint drawn = problem.pointAt(draws[d], set);
            const MountModel model = problem.cleanModel(drawn);
            double difference = 0;
            for (std::size_t r = 0; r < runs.size(); ++r) {
                // What the sensors have wrong is in what is compared and, without a load, in what drives.
                const auto exact = problem.calcExactRun(first + r, drawn);
                difference +=
                    (calcFreeResidual({&exact.motion, exact.relative, {}}, model) - reference[r]).squaredNorm();
            }
            errors[d] = difference / signal;
        } catch (const SimulationDiverged&) {
            errors[d] = std::numeric_limits<double>::infinity();
        } catch (const InputError&) {  // a draw that is no model, as one whose weight nothing carries
            errors[d] = std::numeric_limits<double>::infinity();
        }
    });
    std::sort(errors.begin(), errors.end());
    return std::sqrt(errors[kInside - 1] + noise_floor * noise_floor);
}

}  // namespace wems::identify::updating
