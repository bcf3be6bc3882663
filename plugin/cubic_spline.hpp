/// @file
/// Natural cubic spline through samples: a twice continuously differentiable function of time.
#pragma once

#include <vector>

namespace wems::plugin {

/// Interpolates y over x (strictly increasing, at least one sample); second derivative zero at the ends, constant
/// outside. With samples h apart and angular frequency ω the relative error is about (ωh)⁴/384 away from the ends.
/// Source: de Boor, A Practical Guide to Splines (1978), ch. IV.
class CubicSpline {
public:
    CubicSpline(std::vector<double> x, std::vector<double> y);
    double calcValue(double x) const;

private:
    std::vector<double> x_, y_, curvature_;
};

}  // namespace wems::plugin
