/// @file
/// Numbers that are off together. A tolerance is a part of a number: what a factor makes of believed numbers departs
/// from it by their tolerances times the factor. How much of a mechanism parts alike have goes with their stiffnesses,
/// each of which is believed to its tolerance. A connection that is not where it is believed has the sensors there with
/// it, and they have their own tolerance about that.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "identify/problem/sensor_layout.hpp"
#include "identify/problem/unknown.hpp"
#include "identify/solve/evidence.hpp"

namespace wems::identify::updating {

/// By which the numbers of a direction are their believed ones: the median, as another statement may be about one of
/// them besides. 1 for a single number, and where any is believed to be zero.
/// @param estimate of each column, from the believed state
double calcCommonFactor(const UnknownTable& table, const Direction& direction, const Eigen::VectorXd& estimate);

/// Standard deviations of the columns that a hypothesis knows by their shares of what is common.
/// @param estimate of each column, from the believed state
/// @param[in,out] deviation of each column by itself
void addShares(const Hypothesis& hypothesis, const Eigen::VectorXd& estimate, Eigen::VectorXd& deviation);

/// Leaves such columns where they were, as far as their tolerances about what is common allow.
/// @param before of each column, from the believed state
/// @param[in,out] estimate what is common; the same with each one's own part
void keepShares(const Hypothesis& hypothesis, const Eigen::VectorXd& before, Eigen::VectorXd& estimate);

/// Rows of a connection's position, each beside that of the place of a sensor there.
using CarriedRows = std::vector<std::pair<int, int>>;
CarriedRows findCarried(const UnknownTable& table, const SensorLayout& layout);

/// Tolerances as directions of the prior, each begun by the column that has it.
/// @param deviation of each column by itself
std::vector<Direction> linkTolerances(const Eigen::VectorXd& deviation, const CarriedRows& carried);

}  // namespace wems::identify::updating
