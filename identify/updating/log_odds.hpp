/// @file
/// How much likelier one settled set of causes is than another, where noise comes in bursts.
///
/// While a stop is in contact, its stiffness makes noise of the measured motion a force many times that of the rest of
/// the run. χ² knows the mean power of that noise alone, as if it were there all the time. So χ² differs between two
/// sets, where they differ in what acts in contact, by far more than their numbers are known: in a drawn case by 370
/// where a stop's stiffness differed by 0.8 of its standard deviation.
///
/// Along the step d from the numbers of one set to those of the other, χ² grows by dᵀA d, what is known of it by dᵀA
/// C⁻¹ A d (information.hpp, combine). The difference of χ² counts by the ratio of the two: the vertical adjustment of
/// R. E. Chandler, S. Bate, Inference for clustered data using the independence loglikelihood, Biometrika 94 (2007),
/// doi:10.1093/biomet/asm015.
#pragma once

#include "identify/updating/settling.hpp"
#include "identify/updating/test_problem.hpp"

namespace wems::identify::updating {

/// Part (0 … 1) of χ² along a step that bursts of noise leave as knowledge; 1 where there are none.
/// @param all at the end of the step that leaves less; @param reach of each column (information.hpp, combine)
double calcKnownPart(const Information& all, const BlockScales& scales, const Eigen::VectorXd& reach,
                     const Eigen::VectorXd& step);

/// Log evidence of a settled set over that of another.
/// @param problem left as it was found
double calcLogOdds(TestProblem& problem, const Settler& settler, const SetState& set, const SetState& other);

}  // namespace wems::identify::updating
