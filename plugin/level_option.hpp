/// @file
/// Levels on the command line: `z=200`, `x=100N,y=0.1kN`, `z=1.5g`, `z`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/units.hpp"

namespace wems::plugin {

struct Level {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< SI; an axis without a value is 1
    bool bare = false;                                ///< some axis without a value
    bool with_unit = false;                           ///< some value with a unit
};

/// A number with or without a unit, in SI: `20mm`, `1.5g`, `200`. Without a unit it is SI.
/// @param with_unit set if there is a unit; may be null
/// @throws InputError naming `option`, the text and what is accepted
double parseQuantity(const std::string& text, Quantity quantity, const std::string& option, bool* with_unit = nullptr);

/// @throws InputError if an axis is unknown or given twice, a value is none, or nothing is left
Level parseLevel(const std::string& text, const std::string& option, Quantity quantity);

/// Several levels of one axis: `z=100,200,300`, each as parseLevel would give it alone. One level of several axes,
/// `x=100,y=100`, is one.
std::vector<Level> parseLevels(const std::string& text, const std::string& option, Quantity quantity);

}  // namespace wems::plugin
