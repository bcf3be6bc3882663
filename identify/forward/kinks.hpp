/// @file
/// Where a step leaves the regime that it was made in: a stop closes or opens, a bristle is dragged the other way.
///
/// A step is made as if its regime held throughout (identify/forward/mount_kernel.hpp), so that it is smooth; the
/// relative displacement over it is the cubic through both ends with their velocities, right to fourth order. The step
/// then counts up to the first root of a penetration, or of a velocity.
///
/// All is templates of the kind of number T that the caller integrates with, although it is `double` here: sources of
/// different instruction sets must not share compiled functions.
#pragma once

namespace wems::identify {

/// Motion of an axis at both ends of a step of length h (s).
template <class T>
struct AxisStep {
    double q0, v0, q1, v1, h;

    double displacement(double part) const {
        const double rest = 1 - part;
        return (1 + 2 * part) * rest * rest * q0 + part * rest * rest * h * v0 + part * part * (3 - 2 * part) * q1 -
               part * part * rest * h * v1;
    }
    double velocity(double part) const {
        const double bulge = 6 * ((q1 - q0) / h - (v0 + v1) / 2);
        return v0 + (v1 - v0) * part + bulge * part * (1 - part);
    }
};

inline constexpr double no_kink = 2;

/// First part of the step (0…1) at which `margin` falls below zero; no_kink if it does not.
/// @param margin function of the part, not negative within the regime
/// @param recovers true if a margin that is not positive at the start grows there
template <class Margin>
inline double findKink(const Margin& margin, bool recovers) {
    constexpr int pieces = 8;  // of a step, between which a margin has one root at most
    double from = 0, at_from = margin(0.0);
    if (at_from <= 0 && !recovers) return margin(1.0) < 0 ? 0.0 : no_kink;
    for (int j = 1; j <= pieces; ++j) {
        double to = static_cast<double>(j) / pieces, at_to = margin(to);
        if (at_to >= 0) {
            from = to;
            at_from = at_to;
            continue;
        }
        if (at_from <= 0) return from;
        constexpr double sharpness = 1e-12;  // of the step
        for (int iteration = 0; iteration < 60 && to - from > sharpness; ++iteration) {
            // Secant, pulled off the ends so that both close in.
            double part = from + (to - from) * at_from / (at_from - at_to);
            const double least = 0.05 * (to - from);
            part = part < from + least ? from + least : part > to - least ? to - least : part;
            const double value = margin(part);
            (value >= 0 ? from : to) = part;
            (value >= 0 ? at_from : at_to) = value;
        }
        return to;
    }
    return no_kink;
}

/// @param direction, reach of the stop (models/axis_terms.hpp): penetration = direction · q + reach
template <class T>
inline double findStopKink(const AxisStep<T>& step, double direction, double reach, bool closed) {
    const double sign = closed ? 1.0 : -1.0;
    const double rate0 = sign * direction * step.v0, rate1 = sign * direction * step.v1;
    if (sign * (direction * step.q1 + reach) >= 0) {
        // In contact or out of it at the end too, and on the way, unless it falls at first and rises at last; a
        // parabola's dip is less deep than the tangent at half the step.
        const double tangent = sign * (direction * step.q0 + reach) + 0.5 * step.h * rate0;
        if (!(rate0 < 0 && rate1 > 0 && tangent < 0)) return no_kink;
    }
    const auto margin = [&](double part) { return sign * (direction * step.displacement(part) + reach); };
    return findKink(margin, rate0 > 0);
}

/// What a reversal that is not located may cost, of the sliding force.
inline constexpr double least_reversal = 1e-6;

/// @param direction of the bristle (±1), @param sliding_stretch F / σ (m), @param stretch now (m)
template <class T>
inline double findReversal(const AxisStep<T>& step, double direction, double sliding_stretch, double stretch) {
    const double back = -direction * step.v1 * step.h / 2;  // m travelled the other way, about
    const double size = stretch < 0 ? -stretch : stretch;
    if (!(back * size > least_reversal * sliding_stretch * sliding_stretch)) return no_kink;
    return findKink([&](double part) { return direction * step.velocity(part); }, false);
}

}  // namespace wems::identify
