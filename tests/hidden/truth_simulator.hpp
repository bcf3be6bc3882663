/// @file
/// The truth of hidden cases: rigid body, connections, bracket and an outside effect, integrated with small steps.
#pragma once

#include <Eigen/Core>
#include <stdexcept>

#include "tests/hidden/random_case.hpp"

namespace wems::hidden {

/// Motion of both ends of each connection, row 3 i + axis, one column for each sample; m, m/s².
struct Markers {
    Eigen::MatrixXd mobile, fixed;
    Eigen::MatrixXd mobile_acceleration, fixed_acceleration;
    Eigen::Matrix3Xd load;  ///< N, as commanded
    std::vector<double> time;
};

/// Nothing that can be measured moves like this: an outside effect of no use.
class TruthDiverged : public std::runtime_error {
public:
    TruthDiverged() : std::runtime_error("the truth of a hidden case diverged") {}
};

/// Classical Runge–Kutta with a quarter of a millisecond; a force of the outside effect acts between both parts
/// (a disturbance on the mobile part alone). @throws TruthDiverged
Markers simulateTruth(const HiddenCase& hidden, std::size_t run);

}  // namespace wems::hidden
