/// @file
/// What numbers that one statement moves together have in common. A tolerance is a part of a number: what a factor
/// makes of believed numbers departs from it by their tolerances times the factor.
#pragma once

#include <Eigen/Core>

#include "identify/problem/unknown.hpp"
#include "identify/solve/evidence.hpp"

namespace wems::identify::updating {

/// By which the numbers of a direction are their believed ones: the median, as another statement may be about one of
/// them besides. 1 for a single number, and where any is believed to be zero.
/// @param estimate of each column, from the believed state
double calcCommonFactor(const UnknownTable& table, const Direction& direction, const Eigen::VectorXd& estimate);

}  // namespace wems::identify::updating
