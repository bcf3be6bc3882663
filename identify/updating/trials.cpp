#include "identify/updating/trials.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "identify/updating/naming.hpp"
#include "identify/updating/standing.hpp"

namespace wems::identify::updating {
namespace {

/// Mechanisms with the sign that they can have, numbers beyond their tolerance.
bool isWanted(const TestProblem& problem, const HypothesisSet& set, const Eigen::VectorXd& estimate) {
    if (!isPossible(problem, set, estimate)) return false;
    const TestPoint point = problem.pointAt(estimate, set);
    return std::all_of(set.begin(), set.end(),
                       [&](int h) { return isBeyondTolerance(problem, problem.hypotheses()[h], point); });
}

/// Gauss–Newton steps of a trial that is not of first order.
/// @return −2 log of likelihood and prior where they lead, as the present view has it
double refine(TestProblem& problem, const Settler& settler, const SetState& present, const Evidence& evidence,
              Trial& trial) {
    const TestProblem::Memento before = problem.adopt(trial.set);
    TestPoint point = settler.refine(trial.point, trial.set, present.scales, kMostRefining);
    const double prior = settler.calcPriorSquare(problem.estimateOf(point), trial.set);
    problem.restore(before);
    const Eigen::VectorXd estimate = problem.estimateOf(point);
    trial.point = std::move(point);
    return evidence.calcChange(estimate) + prior +
           settler.calcExcess(present.view, trial.point, estimate, present.scales);
}

}  // namespace

std::vector<Trial> tryBest(TestProblem& problem, const Settler& settler, const SetState& present,
                           const Evidence& evidence, const std::vector<RankedSet>& ranked) {
    const Eigen::VectorXd here = problem.estimateOf(present.point);
    std::vector<Trial> trials{{present.set, present.point, evidence.calcLogEvidence(present.set)}};
    std::vector<std::string> known{signatureOf(problem, present.set)};
    const SetSolution settled = evidence.solve(present.set);
    // The present point is near the quadratic's estimate of its set: a trial differs from it as the estimates do.
    const Eigen::VectorXd shift = here - settled.mean;
    std::vector<double> promised{trials.front().log_evidence};
    for (const RankedSet& entry : ranked) {
        if (trials.size() > kTried) break;
        const std::string signature = signatureOf(problem, entry.members);
        if (std::find(known.begin(), known.end(), signature) != known.end()) continue;
        const Eigen::VectorXd target = evidence.solve(entry.members).mean + shift;
        if (!isWanted(problem, entry.members, target)) continue;
        known.push_back(signature);
        Trial trial{entry.members, problem.pointAt(target, entry.members), entry.log_evidence};
        const double excess = settler.calcExcess(present.view, trial.point, target, present.scales);
        trial.log_evidence -= 0.5 * std::max(0.0, excess);
        trials.push_back(std::move(trial));
        promised.push_back(entry.log_evidence);
        if (entry.log_evidence < trials.front().log_evidence - kUnlikely) break;
    }
    const double best = std::max_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
                            return a.log_evidence < b.log_evidence;
                        })->log_evidence;
    // Rivals of the best one are compared where their own steps lead.
    std::vector<std::size_t> rivals;
    for (std::size_t i = 1; i < trials.size(); ++i)
        if (promised[i] > std::max(best - kUnlikely, trials.front().log_evidence)) rivals.push_back(i);
    if (rivals.size() == 1 && trials[rivals.front()].log_evidence == best) return trials;
    const double square = evidence.calcChange(here) + settler.calcPriorSquare(here, present.set);
    for (const std::size_t i : rivals) {
        Trial& trial = trials[i];
        const double occam = evidence.solve(trial.set).occam - settled.occam;
        const double gained = square - refine(problem, settler, present, evidence, trial);
        trial.log_evidence = std::max(trial.log_evidence, trials.front().log_evidence + occam + 0.5 * gained);
    }
    return trials;
}

}  // namespace wems::identify::updating
