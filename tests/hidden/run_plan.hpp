/// @file
/// The excitation of one run of a hidden case.
#pragma once

#include <Eigen/Core>
#include <string>

#include "tests/hidden/random_numbers.hpp"

namespace wems::hidden {

/// Samples of excitation tables, Hz: some forty for each period of the highest excited frequency.
inline constexpr double kTableRate = 2000;
/// Excited band, Hz.
inline constexpr double kLowest = 5, kHighest = 50;

enum class Excitation { logarithmic, linear, random };

/// A unit excitation along a direction: a load (N), or a table that is driven by a unit acceleration.
struct RunPlan {
    Excitation excitation = Excitation::logarithmic;
    bool upward = true;
    double duration = 12;  ///< s
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    double level = 0;           ///< N or m/s²
    Eigen::VectorXd signal;     ///< at kTableRate: of unit amplitude (random: unit RMS); the acceleration of a table
    Eigen::VectorXd travel;     ///< m for a signal of 1 m/s²; of a table alone
    Eigen::VectorXd frequency;  ///< Hz, swept; empty of a random excitation
};

/// `logarithmic sweep up`, `linear sweep down`, `random` …
std::string formatExcitation(const RunPlan& plan);

/// Fills signal and frequency of a plan.
/// @param table the excitation moves a table, whose suspension (0.3 times the lowest frequency, damping ratio 0.7)
/// takes the slow part away, so that it starts at rest and stays where it is
void tabulate(RunPlan& plan, bool table, std::uint64_t seed);

/// Rows interpolated between samples: cubic Hermite with slopes of fourth order, constant beyond the ends.
Eigen::MatrixXd resample(const Eigen::MatrixXd& rows, double from_rate, double to_rate, Eigen::Index count);

}  // namespace wems::hidden
