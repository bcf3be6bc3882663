/// @file
/// Monotone splines over a range of displacements (I-splines: Ramsay 1988, doi:10.1214/ss/1177012761): any non-negative
/// sum of them is a force curve that never falls.
///
/// On knots k h, k an integer, the slopes are the quadratic B-splines of that spacing, and each curve is what they add
/// up to: a cubic between two knots, C² at each, so that rows with slopes (models/force_curve.hpp) are it exactly. All
/// are less their value at rest. Their sum is a spring of 1 N/m.
#pragma once

#include <vector>

#include "models/force_curve.hpp"

namespace wems::identify {

/// Curves over displacements from `lower` to `upper` (m), all with the same rows. @param cells over the range
std::vector<std::vector<CurveRow>> makeMonotoneCurves(double lower, double upper, int cells);

/// `curve` plus a weight times `part`, which has the same displacements; empty `curve`: no force.
void addCurve(const std::vector<CurveRow>& part, double weight, std::vector<CurveRow>& curve);

}  // namespace wems::identify
