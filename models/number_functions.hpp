/// @file
/// Functions that models/axis_terms.hpp and the forward model's equations ask of a number, for `double`.
/// identify/forward/pack.hpp has them for packs.
#pragma once

#include <cmath>

namespace wems {

inline double positivePart(double x) {
    return x > 0 ? x : 0.0;
}
inline double hyperbolicTangent(double x) {
    return std::tanh(x);
}
/// 1 − exp(−x) for x ≥ 0, its tangent x for x < 0.
inline double decayedPart(double x) {
    return x > 0 ? -std::expm1(-x) : x;
}
inline double reciprocalRoot(double x) {
    return 1 / std::sqrt(x);
}

/// A function of numbers that has no form for packs: of each lane by itself.
template <class Function, class... More>
inline double perNumber(const Function& function, double first, More... more) {
    return function(first, more...);
}

}  // namespace wems
