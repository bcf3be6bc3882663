/// @file
/// What a hypothesis sets free, on top of the tolerances that every number has anyway.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace wems::identify {

/// A direction in the space of columns: the unknown z ~ N(0, 1) moves each column's number by weight · z.
using Direction = std::vector<std::pair<int, double>>;

/// One physical statement: these numbers are off by far more than their tolerance, or this mechanism is there.
struct Hypothesis {
    std::string cause;               ///< `elastomer_stiffness`, as results name it
    std::vector<std::string> where;  ///< `4.z`, `body`, `mobile.1.az`
    std::vector<Direction> directions;
    std::vector<int> reported;  ///< rows of the parameter table that results list

    /// Where the law is not linear in a number, the directions above are of columns far from the state. Once taken, the
    /// state moves there, these rows count from their new values, and `tangent` replaces the directions.
    std::vector<std::pair<int, double>> start;
    std::vector<Direction> tangent;
    std::vector<std::pair<int, int>> moves;  ///< a probe's column and the row that its amplitude is added to

    double log_prior = 0;  ///< log of the prior odds of the statement against its absence
};

/// Indices into the list of hypotheses, ascending.
using HypothesisSet = std::vector<int>;

}  // namespace wems::identify
