/// @file
/// Stops that the motion does not reach at a point, though it may within their tolerances. Such a stop has no slope: no
/// step of Gauss and Newton brings it nearer, however much its contact would explain.
#pragma once

#include <vector>

#include "identify/updating/test_problem.hpp"
#include "models/axis_law.hpp"

namespace wems::identify::updating {

struct UntouchedStop {
    int connection = 0, axis = 0;
    Stop stop;
    double offset = 0;   ///< m, of its axis
    int row = 0;         ///< of its clearance in the table
    double reached = 0;  ///< m: the clearance at which the motion would just touch it
    double nearest = 0;  ///< m: the believed clearance less its tolerance; below `reached`
};

/// Of all runs, with their sensors' errors taken off as the point has them. Not of axes with a measured force curve.
std::vector<UntouchedStop> findUntouchedStops(const TestProblem& problem, const TestPoint& point);

}  // namespace wems::identify::updating
