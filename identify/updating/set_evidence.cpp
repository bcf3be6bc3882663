#include "identify/updating/set_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace wems::identify::updating {
namespace {

std::vector<Hypothesis> collect(const TestProblem& problem, const HypothesisSet& set) {
    std::vector<Hypothesis> members;
    for (const int h : set) members.push_back(problem.hypotheses()[h]);
    return members;
}

}  // namespace

std::vector<double> calcMeanSquares(const Information& actual) {
    std::vector<double> misfits;
    for (const BlockInformation& block : actual) misfits.push_back(block.empty() ? 0 : block.chi_squared / block.count);
    return misfits;
}

bool isSatisfied(const std::vector<double>& misfits) {
    return std::all_of(misfits.begin(), misfits.end(), [](double misfit) { return misfit < kSatisfied; });
}

Evidence makeEvidence(const TestProblem& problem, const TestView& view, const HypothesisSet& set,
                      const BlockScales& scales, bool with_validation) {
    return {combine(sumOf(view, with_validation), scales, problem.reaches()),
            problem.tolerances(set, problem.estimateOf(view.at)), problem.hypotheses()};
}

Information sumOf(const TestInformation& runs, bool with_validation) {
    Information all = runs.identification;
    if (with_validation) add(all, runs.validation);
    return all;
}

std::vector<double> calcMisfits(const Information& all, const Eigen::VectorXd& estimate) {
    std::vector<double> misfits;
    for (std::size_t k = 0; k < kBlocks; ++k) misfits.push_back(calcBlockMisfit(all[k], estimate));
    return misfits;
}

double calcExcessOf(const std::vector<double>& misfits) {
    return *std::max_element(misfits.begin(), misfits.end()) - 1;
}

bool hasBursts(const Information& all) {
    return std::any_of(all.begin(), all.end(), [](const BlockInformation& block) { return block.scatter.size() > 0; });
}

std::vector<double> calcScatter(const Information& all) {
    std::vector<double> scatter;
    for (const BlockInformation& block : all) scatter.push_back(block.empty() ? 0 : std::sqrt(2 / block.count));
    return scatter;
}

bool isNoiseAlone(const Information& all, const std::vector<double>& misfits) {
    const std::vector<double> scatter = calcScatter(all);
    for (std::size_t k = 0; k < kBlocks; ++k) {
        // Of many values the mean scatters little: what is not known of it is the noise's level, in each band by
        // itself.
        const auto bands = static_cast<double>(all[k].noise_slopes.cols());
        const double level = bands > 0 ? kLevelDeviation / std::sqrt(bands) : 0;
        if (misfits[k] - 1 > kBeyondNoise * std::hypot(scatter[k], level)) return false;
    }
    return true;
}

SetEvidence::SetEvidence(const TestProblem& problem, const Information& all, const BlockScales& scales,
                         const HypothesisSet& set, const Eigen::VectorXd& estimate, Growth growth)
    : members_(collect(problem, set)),
      evidence_(combine(all, scales, problem.reaches(), growth), problem.tolerances(set, estimate), members_) {
    for (std::size_t i = 0; i < members_.size(); ++i) all_.push_back(static_cast<int>(i));
}

}  // namespace wems::identify::updating
