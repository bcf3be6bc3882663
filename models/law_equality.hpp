/// @file
/// Whether two laws are the same in every parameter. What asks for laws that differ, or that exert nothing, asks
/// here. A parameter that a law gains and that is not compared does not compile.
#pragma once

#include "models/axis_law.hpp"

namespace wems {

bool operator==(const Stop& a, const Stop& b);
bool operator==(const Relaxation& a, const Relaxation& b);
bool operator==(const Friction& a, const Friction& b);
bool operator==(const Hysteresis& a, const Hysteresis& b);
bool operator==(const MaxwellBranch& a, const MaxwellBranch& b);
bool operator==(const Slider& a, const Slider& b);
bool operator==(const CurveRow& a, const CurveRow& b);
bool operator==(const AxisLaw& a, const AxisLaw& b);

}  // namespace wems
