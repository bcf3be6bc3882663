/// @file
/// What all runs of a view leave, and the evidence of one set of causes there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/updating/test_problem.hpp"

namespace wems::identify::updating {

/// Misfit per value up to which equations of motion count as satisfied: noise, and what sampling makes of a stop, leave
/// 0.9 to 2.1 on recordings of another simulator whose cause is known.
inline constexpr double kSatisfied = 3;

/// Whether no block leaves so much.
bool isSatisfied(const std::vector<double>& misfits);

/// The evidence of one set alone: its members, and nothing else to weigh.
class SetEvidence {
public:
    /// @param estimate about which tolerances are what they are (TestProblem::deviations)
    SetEvidence(const TestProblem& problem, const Information& all, const BlockScales& scales, const HypothesisSet& set,
                const Eigen::VectorXd& estimate, Growth growth = Growth::doubted);
    SetEvidence(const SetEvidence&) = delete;
    SetEvidence& operator=(const SetEvidence&) = delete;
    SetSolution solve() const { return evidence_.solve(all_); }
    Eigen::VectorXd solveNear(const Eigen::VectorXd& slope, double damping) const {
        return evidence_.solveNear(all_, slope, damping);
    }
    double calcChange(const Eigen::VectorXd& estimate) const { return evidence_.calcChange(estimate); }
    Posterior calcPosterior() const { return evidence_.calcPosterior(all_); }

private:
    std::vector<Hypothesis> members_;
    HypothesisSet all_;
    Evidence evidence_;
};

/// Evidence of all runs, or of the identification runs alone, at a view. @param set whose tolerances count there
Evidence makeEvidence(const TestProblem& problem, const TestView& view, const HypothesisSet& set,
                      const BlockScales& scales, bool with_validation);

/// Runs of a view together: the identification runs, or all.
Information sumOf(const TestInformation& runs, bool with_validation);

/// Misfit of each block at an estimate.
std::vector<double> calcMisfits(const Information& all, const Eigen::VectorXd& estimate);

/// χ² of each block over its count, of a misfit without quadratic.
std::vector<double> calcMeanSquares(const Information& actual);

/// Beyond the noise, of the block that leaves most.
double calcExcessOf(const std::vector<double>& misfits);

/// Whether noise comes in bursts, as in contact: V of information.hpp.
bool hasBursts(const Information& all);

/// Standard deviations of a misfit: less is noise, which any number may halve.
inline constexpr double kBeyondNoise = 1.96;
/// Standard deviation of each block's misfit if the model is perfect.
std::vector<double> calcScatter(const Information& all);
/// Whether no block leaves more than a perfect model would.
bool isNoiseAlone(const Information& all, const std::vector<double>& misfits);

}  // namespace wems::identify::updating
