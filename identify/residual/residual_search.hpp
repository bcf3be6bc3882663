/// @file
/// Which causes the tests of an element speak for: additions, exchanges and removals by the evidence, each with its
/// most probable numbers (residual_problem.hpp), as far as the tests that judge need them.
#pragma once

#include <vector>

#include "identify/residual/residual_problem.hpp"
#include "models/common/progress.hpp"

namespace wems::identify {

struct ResidualAnswer {
    ResidualFit adjusted;             ///< tolerances alone
    ResidualFit best;                 ///< with the causes
    std::vector<ResidualFit> ranked;  ///< the best, it without each member, and with each member exchanged
    std::vector<Decision> decisions;
};

ResidualAnswer searchCauses(const ResidualProblem& problem, const ProgressListener& progress);

/// The best fit without one cause: a mechanism left out, a number kept at its tolerance; all else is fitted anew.
ResidualFit leaveOut(const ResidualProblem& problem, const ResidualFit& fit, int member);

}  // namespace wems::identify
