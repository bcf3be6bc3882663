/// @file
/// The force law of one axis as arithmetic on numbers of any kind: `double`, or a pack of several parameter sets
/// (identify/forward/pack.hpp). models/axis_law.hpp has the equations; AxisForce and the fast forward model both
/// evaluate them here.
///
/// The constants of an axis stand one after the other, in the order in which they are read:
///
///     elastomer k − …, its drift per second, quadratic, cubic, damping
///     of each stop         direction, direction · offset − clearance, direction · stiffness, direction · dissipation
///     of sliding friction  force, 1 / transition velocity
///     of each branch       stiffness, 1 / time constant
///     of a bristle         stiffness σ, sliding stretch F / σ, 1 if it stretches at all
///     of hysteresis, and of each slider
///                          stiffness F₊ / Y, sliding stretch Y + g/2, exponent n, 2 β − 1, stiffness F₋ / Y, g/2
///     of a force curve     force and displacement of the first row, slope there, displacement of the last row, slope
///     of each segment      displacement where it begins, length, slope there, square and cube term
///
/// Bristle, hysteresis and sliders are *dragged*: their stretch follows from the travel alone, and turns where the
/// motion does.
#pragma once

#include "models/hysteresis_terms.hpp"

namespace wems {

/// How many branches and sliders a law may list, and how many internal states it then has at most: with those of
/// relaxation, structural damping, bristle and hysteresis.
inline constexpr int kMostBranches = 24, kMostSliders = 16, kMostStates = kMostBranches + kMostSliders + 6;

/// Which terms an axis has. Parameter sets that are evaluated together share it.
struct AxisShape {
    int stops = 0;
    int branches = 0;
    bool sliding = false, bristle = false;
    int hystereses = 0;      ///< hysteresis and sliders
    int curve_segments = 0;  ///< cubics of a force curve

    /// How many states are dragged: they come after those of the branches, the bristle first.
    int draggedCount() const { return (bristle ? 1 : 0) + hystereses; }
    int stateCount() const { return branches + draggedCount(); }
    /// Where constants begin, and how many there are.
    int stopConstants(int stop) const { return 5 + 4 * stop; }
    int branchConstants() const { return stopConstants(stops) + (sliding ? 2 : 0); }
    int bristleConstants() const { return branchConstants() + 2 * branches; }
    int hysteresisConstants(int i) const { return bristleConstants() + (bristle ? 3 : 0) + 6 * i; }
    /// Of a dragged state. The second constant of each is the stretch at which it slides.
    int draggedConstants(int dragged) const {
        if (!bristle) return hysteresisConstants(dragged);
        return dragged == 0 ? bristleConstants() : hysteresisConstants(dragged - 1);
    }
    int curveConstants() const { return hysteresisConstants(hystereses); }
    int constantCount() const { return curveConstants() + (curve_segments > 0 ? 5 + 5 * curve_segments : 0); }
    bool operator==(const AxisShape& other) const {
        return stops == other.stops && branches == other.branches && sliding == other.sliding &&
               bristle == other.bristle && hystereses == other.hystereses && curve_segments == other.curve_segments;
    }
};

/// Penetration of a stop, positive in contact. @param stop its four constants
template <class T>
inline T calcPenetration(const T* stop, const T& q) {
    return stop[0] * q + stop[1];
}

/// Force (N) of a hysteresis or slider stretched by z (m). @param c its constants
template <class T>
inline T calcHysteresisForce(const T* c, const T& z) {
    return c[0] * positivePart(z - c[5]) - c[4] * positivePart(T(0.0) - z - c[5]);
}

/// Force (N) of a curve (models/force_curve.hpp): what each segment adds up to q, so that packs need no search.
/// @param c its constants
template <class T>
inline T calcCurveForce(const T* c, int segments, const T& q) {
    T f = c[0] - c[2] * positivePart(c[1] - q) + c[4] * positivePart(q - c[3]);
    c += 5;
    for (int i = 0; i < segments; ++i, c += 5) {
        const T beyond = positivePart(q - c[0]);
        const T x = beyond - positivePart(beyond - c[1]);
        f += x * (c[2] + x * (c[3] + x * c[4]));
    }
    return f;
}

/// f (N).
/// @param constants of the axis
/// @param closed closed(i, penetration) is 1 if stop i counts as in contact, otherwise 0
/// @param z internal states, branches first, then what is dragged
template <class T, class Closed>
inline T calcAxisForce(const AxisShape& shape, const T* constants, const Closed& closed, const T& q, const T& v,
                       const T& t, const T* z) {
    const T* c = constants;
    T f = (c[0] + c[1] * t + (c[2] + c[3] * q) * q) * q + c[4] * v;
    c += 5;
    for (int i = 0; i < shape.stops; ++i, c += 4) {
        const T penetration = calcPenetration(c, q);
        f += closed(i, penetration) * c[2] * penetration * positivePart(T(1.0) + c[3] * v);
    }
    if (shape.sliding) {
        f += c[0] * hyperbolicTangent(v * c[1]);
        c += 2;
    }
    for (int b = 0; b < shape.branches; ++b, c += 2) f += c[0] * (q - *z++);
    if (shape.bristle) f += constants[shape.bristleConstants()] * *z++;
    for (int i = 0; i < shape.hystereses; ++i) f += calcHysteresisForce(constants + shape.hysteresisConstants(i), *z++);
    if (shape.curve_segments > 0) f += calcCurveForce(constants + shape.curveConstants(), shape.curve_segments, q);
    return f;
}

/// z' (m/s). @param direction of the motion for each dragged state, ±1
template <class T>
inline void calcAxisStateRates(const AxisShape& shape, const T* constants, const T* direction, const T& q, const T& v,
                               const T* z, T* zdot) {
    const T* c = constants + shape.branchConstants();
    for (int b = 0; b < shape.branches; ++b, c += 2) *zdot++ = (q - *z++) * c[1];
    if (shape.bristle) *zdot++ = c[2] * v * (T(1.0) - *direction++ * *z++ / c[1]);
    for (int i = 0; i < shape.hystereses; ++i)
        *zdot++ = calcHysteresisRate(constants + shape.hysteresisConstants(i), *direction++, v, *z++);
}

/// The bristle after a travel in one direction, exactly: ds/dq = 1 − direction · s / (F / σ). A travel against the
/// direction, which only the stages of a step make, follows the tangent.
/// @param c constants of the bristle
template <class T>
inline T calcBristle(const T* c, const T& direction, const T& before, const T& travel) {
    const T x = direction * travel / c[1];
    return before + c[2] * (direction * c[1] - before) * decayedPart(x);
}

/// A dragged state after a travel.
/// @param constants of the axis
template <class T>
inline T calcDragged(const AxisShape& shape, const T* constants, int dragged, const T& direction, const T& before,
                     const T& travel) {
    const T* c = constants + shape.draggedConstants(dragged);
    return shape.bristle && dragged == 0 ? calcBristle(c, direction, before, travel)
                                         : calcHysteresis(c, direction, before, travel);
}

}  // namespace wems
