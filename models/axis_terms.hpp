/// @file
/// The force law of one axis as arithmetic on numbers of any kind: `double`, or a pack of several parameter sets
/// (identify/forward/pack.hpp). models/axis_law.hpp has the equations; AxisForce and the fast forward model both
/// evaluate them here.
///
/// The constants of an axis stand one after the other, in the order in which they are read:
///
///     elastomer k − …, its drift per second, cubic, damping
///     of each stop         direction, direction · offset − clearance, direction · stiffness, direction · dissipation
///     of sliding friction  force, 1 / transition velocity
///     of each branch       stiffness, 1 / time constant
///     of a bristle         stiffness σ, sliding stretch F / σ, 1 if it stretches at all
#pragma once

#include "models/number_functions.hpp"

namespace wems {

/// Which terms an axis has. Parameter sets that are evaluated together share it.
struct AxisShape {
    int stops = 0;
    int branches = 0;
    bool sliding = false, bristle = false;

    int stateCount() const { return branches + (bristle ? 1 : 0); }
    /// Where constants begin, and how many there are.
    int stopConstants(int stop) const { return 4 + 4 * stop; }
    int branchConstants() const { return stopConstants(stops) + (sliding ? 2 : 0); }
    int bristleConstants() const { return branchConstants() + 2 * branches; }
    int constantCount() const { return bristleConstants() + (bristle ? 3 : 0); }
    bool operator==(const AxisShape& other) const {
        return stops == other.stops && branches == other.branches && sliding == other.sliding &&
               bristle == other.bristle;
    }
};

/// Penetration of a stop, positive in contact. @param stop its four constants
template <class T>
inline T calcPenetration(const T* stop, const T& q) {
    return stop[0] * q + stop[1];
}

/// f (N).
/// @param c constants of the axis
/// @param closed closed(i, penetration) is 1 if stop i counts as in contact, otherwise 0
/// @param z internal states, branches first
template <class T, class Closed>
inline T calcAxisForce(const AxisShape& shape, const T* c, const Closed& closed, const T& q, const T& v, const T& t,
                       const T* z) {
    T f = (c[0] + c[1] * t + c[2] * q * q) * q + c[3] * v;
    c += 4;
    for (int i = 0; i < shape.stops; ++i, c += 4) {
        const T penetration = calcPenetration(c, q);
        f += closed(i, penetration) * c[2] * penetration * positivePart(T(1.0) + c[3] * v);
    }
    if (shape.sliding) {
        f += c[0] * hyperbolicTangent(v * c[1]);
        c += 2;
    }
    for (int b = 0; b < shape.branches; ++b, c += 2) f += c[0] * (q - *z++);
    if (shape.bristle) f += c[0] * *z;
    return f;
}

/// z' (m/s). @param direction sign of v
template <class T>
inline void calcAxisStateRates(const AxisShape& shape, const T* c, const T& direction, const T& q, const T& v,
                               const T* z, T* zdot) {
    c += shape.branchConstants();
    for (int b = 0; b < shape.branches; ++b, c += 2) *zdot++ = (q - *z++) * c[1];
    if (shape.bristle) *zdot = c[2] * v * (T(1.0) - direction * *z / c[1]);
}

/// The bristle after a travel in one direction, exactly: ds/dq = 1 − direction · s / (F / σ). A travel against the
/// direction, which only the stages of a step make, follows the tangent.
/// @param c constants of the bristle
template <class T>
inline T calcBristle(const T* c, const T& direction, const T& before, const T& travel) {
    const T x = direction * travel / c[1];
    return before + c[2] * (direction * c[1] - before) * decayedPart(x);
}

}  // namespace wems
