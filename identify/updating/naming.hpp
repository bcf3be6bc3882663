/// @file
/// When a number is a cause: it lies beyond its tolerance, and the prediction needs it there (contract, section 5: a
/// number that is off by less than its tolerance is no cause but an adjustment).
#pragma once

#include <string>
#include <vector>

#include "identify/updating/settling.hpp"

namespace wems::identify::updating {

/// `clearance 4.z.+ 4.z.-`
std::string describe(const Hypothesis& hypothesis);
std::vector<std::string> describe(const TestProblem& problem, const HypothesisSet& set);

/// What a set says, where and of which numbers: two sets of one statement differ only in where they began to look.
std::string signatureOf(const TestProblem& problem, const HypothesisSet& set);

/// Of a sensor, whose faults free simulations need not show.
bool isSensorFault(const Hypothesis& hypothesis);

/// A number that the model or the measurement has, with a tolerance; anything else is a mechanism that the model lacks.
bool isToleranced(const TestProblem& problem, const Hypothesis& hypothesis);

/// Whether a number of the hypothesis lies beyond its tolerance (2 standard deviations of its prior), and that of each
/// place if each has its own; mechanisms always do.
bool isBeyondTolerance(const TestProblem& problem, const Hypothesis& hypothesis, const TestPoint& point);

/// Whether a set moves a number of the table freely.
bool isFreed(const TestProblem& problem, const HypothesisSet& set, int row);

/// Log prior that numbers beyond their tolerances in one state get back in another, which frees them or has them closer
/// to what is believed.
double calcRelief(const TestProblem& problem, const SetState& before, const SetState& after);

/// Probability that a number of the hypothesis lies beyond its tolerance, on either side, the likeliest of them; of
/// places with a number each, the unlikeliest.
double calcBeyondProbability(const TestProblem& problem, const Hypothesis& hypothesis, const TestPoint& point,
                             const Posterior& posterior);

/// Whether mechanisms come out with the sign that they can have.
bool isPossible(const TestProblem& problem, const HypothesisSet& set, const Eigen::VectorXd& estimate);

/// Whether one estimate leaves at most half of what another leaves beyond the noise, in a block that it does not
/// satisfy.
bool takesHalf(const Information& all, const Eigen::VectorXd& with, const Eigen::VectorXd& without);

/// The point with the numbers of a hypothesis brought back to their tolerance, all else as it is.
TestPoint bringBack(const TestProblem& problem, const SetState& state, const Hypothesis& hypothesis);

/// The point without one cause of a state, all other numbers following by first order: what has a tolerance is brought
/// back to it, a mechanism is left out. Where numbers are exact, one without its cause is as believed.
/// @param evidence of the state's view, with all hypotheses
TestPoint holdBack(const TestProblem& problem, const SetState& state, int member, const Evidence& evidence);

}  // namespace wems::identify::updating
