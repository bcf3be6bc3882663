/// @file
/// What the law of an element on a test machine may have wrong or lack, as hypotheses (contract, section 5).
#pragma once

#include <string>
#include <vector>

#include "identify/problem/unknown.hpp"
#include "identify/solve/hypothesis.hpp"

namespace wems::identify {

/// What the tests did.
struct ElementReach {
    std::string place;                  ///< `1.z`
    double lowest = 0, highest = 0;     ///< Hz, of the strokes
    double positive = 0, negative = 0;  ///< m, largest displacement towards either side
    double displacement = 0;            ///< m, the larger of both
};

/// @param table rows of the law, and the delay of the force's channel
/// @param believed with a stop on either side, of no stiffness where the model has none
std::vector<Hypothesis> listElementHypotheses(const UnknownTable& table, const AxisLaw& believed,
                                              const ElementReach& reach);

}  // namespace wems::identify
