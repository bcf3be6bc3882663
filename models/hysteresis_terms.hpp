/// @file
/// Smooth hysteresis after Bouc and Wen (Wen 1976, doi:10.1061/JMCEA3.0002106) as arithmetic on numbers of any kind.
///
/// A spring of stiffness F / Y is stretched by z (m), |z| ≤ Y, and gives the force F z / Y. Wen's equation,
/// with β + γ = 1 so that Y is the largest stretch,
///
///     z' = v − β |v| |z/Y|^(n−1) z/Y − γ v |z/Y|^n
///
/// is z' = v g(w), with w = ± z / Y counted along the motion and
///
///     g = 1 − w^n                    w ≥ 0: on the way to the sliding level
///     g = 1 + (2 β − 1) (−w)^n       w < 0: on the way back from the other one
///
/// does not know how fast the motion is: z follows from the travel alone. n = 1 with β = 1 is the bristle of presliding
/// friction. With n = ∞ and β = 1/2 the stretch follows the motion up to Y and stays there: a slider with a corner. The
/// constants that are asked for here are the second to the fourth of models/axis_terms.hpp: Y, n, 2 β − 1.
#pragma once

#include <cmath>

namespace wems {

// Functions that models/axis_terms.hpp and the forward model's equations ask of a number, for `double`.
// identify/forward/pack.hpp has them for packs.

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

namespace hysteresis {

// Scalar functions are templates of the kind of number T that the caller calculates with: sources of different
// instruction sets must not share compiled functions.

/// g(w).
template <class T>
inline double calcSlope(double w, double exponent, double release) {
    if (exponent > 1e300) return w < 1 ? 1 : 0;  // a corner, which an integrator's step may pass
    return w < 0 ? 1 + release * __builtin_pow(-w, exponent) : 1 - __builtin_pow(w, exponent);
}

/// g(w) / (1 − w) for w = 1 − rest ≥ 0, exact where hardly anything is left to the level.
template <class T>
inline double calcApproach(double rest, double exponent) {
    constexpr double rounding = 1e-16;
    if (rest >= 1) return 1;
    if (rest < rounding && rest > -rounding) return exponent;
    return -__builtin_expm1(exponent * __builtin_log1p(-rest)) / rest;
}

/// Pieces no longer than 1 / (4 n) of the largest stretch (1/8 for small n), but no more than `most`: within 1e-6.
template <class T>
inline int countPieces(double length, double exponent, double most) {
    const double count = __builtin_ceil(4 * length * (exponent > 2 ? exponent : 2));
    return static_cast<int>(count < 1 ? 1 : count < most ? count : most);
}

/// The way back, w = −back < 0, in pieces whose travel is an integral of 1 / g. Where the travel ends before w is 0,
/// the rest of it is a step of Runge and Kutta.
/// @return travel that is left, zero if it did not suffice
template <class T>
inline double followBack(double& back, double travel, double exponent, double release) {
    constexpr double nodes[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
    constexpr double weights[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
    const int pieces = countPieces<T>(back, exponent, 8 * exponent + 8);
    const double piece = back / pieces;
    for (int rest = pieces; rest > 0; --rest) {
        double whole = 0;
        for (int i = 0; i < 4; ++i)
            whole += 0.5 * piece * weights[i] / calcSlope<T>((0.5 + 0.5 * nodes[i] - rest) * piece, exponent, release);
        if (whole > travel) {
            const auto slope = [&](double gone) {
                return calcSlope<T>(gone < back ? gone - back : 0.0, exponent, release);
            };
            const double k1 = slope(0), k2 = slope(0.5 * travel * k1), k3 = slope(0.5 * travel * k2);
            back -= travel / 6 * (k1 + 2 * (k2 + k3) + slope(travel * k3));
            return 0;
        }
        travel -= whole;
        back = (rest - 1) * piece;
    }
    return travel;
}

/// The same for n = 1, where both branches are linear and their solutions exponentials.
template <class T>
inline double followLinear(double w, double travel, double release) {
    if (w < 0) {
        const double rest = 1 - release * w;  // the slope, which decays to 1 where w is 0
        const double whole = release > 0 ? __builtin_log(rest) / release : -w;
        if (travel < whole) return release > 0 ? w - rest / release * __builtin_expm1(-release * travel) : w + travel;
        travel -= whole;
        w = 0;
    }
    return w - (1 - w) * __builtin_expm1(-travel);
}

/// w after a travel (over Y) in its direction. What is left to the level decays with the rate of calcApproach, which
/// has bounds, so that no travel is too long. Against the direction, which only the stages of a step go: the tangent.
template <class T>
inline double follow(double w, double travel, double exponent, double release) {
    if (!(travel > 0)) return w + travel * calcSlope<T>(w, exponent, release);
    if (exponent > 1e300) return w + travel < 1 ? w + travel : 1.0;  // a corner
    if (exponent == 1) return followLinear<T>(w, travel, release);
    if (w < 0) {
        double back = -w;
        travel = followBack<T>(back, travel, exponent, release);
        if (back > 0) return -back;
        w = 0;
    }
    // Beyond the cap all is at its level.
    const int pieces = countPieces<T>(travel, exponent, 4 * (exponent + 20));
    const double piece = travel / pieces;
    double decay = 0;  // of what is left, its logarithm
    const auto rate = [&](double more) { return calcApproach<T>((1 - w) * __builtin_exp(-decay - more), exponent); };
    for (int i = 0; i < pieces; ++i) {
        const double k1 = rate(0), k2 = rate(0.5 * piece * k1), k3 = rate(0.5 * piece * k2);
        decay += piece / 6 * (k1 + 2 * (k2 + k3) + rate(piece * k3));
    }
    return w - (1 - w) * __builtin_expm1(-decay);
}

}  // namespace hysteresis

/// z (m) after a travel (m). @param c the constants, @param direction of the motion, ±1
template <class T>
inline T calcHysteresis(const T* c, const T& direction, const T& before, const T& travel) {
    return perNumber(
        [](double sign, double z, double x, double yield, double exponent, double release) {
            return sign * yield * hysteresis::follow<T>(sign * z / yield, sign * x / yield, exponent, release);
        },
        direction, before, travel, c[1], c[2], c[3]);
}

/// z' (m/s).
template <class T>
inline T calcHysteresisRate(const T* c, const T& direction, const T& v, const T& z) {
    return v * perNumber([](double w, double exponent,
                            double release) { return hysteresis::calcSlope<T>(w, exponent, release); },
                         direction * z / c[1], c[2], c[3]);
}

}  // namespace wems
