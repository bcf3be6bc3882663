/// @file
/// The forward model's equations (identify/forward/forward_model.hpp) as arithmetic on numbers of any kind: `double`
/// for one simulation, a Pack for several parameter sets at once. Nothing is allocated, nothing is shared.
///
/// The state is: CoG position (G), quaternion (w x y z) of R_GM, CoG velocity (G), angular velocity (M), modal
/// coordinates, their rates, internal states of the connections.
///
/// A *regime* says which branch of each kink holds: the stops in contact, the direction that each bristle is dragged
/// in. Within a regime all is smooth, so that an integrator keeps its order; identify/forward/kinks.hpp tells when one
/// ends. Bristles are no differential equation here: their stretch follows from the travel since the regime's anchor,
/// however fast the sliding is. All that is dragged counts as a bristle, hysteresis too (models/axis_terms.hpp).
#pragma once

#include "identify/forward/pack.hpp"
#include "models/axis_terms.hpp"

namespace wems::identify {

inline constexpr int at_position = 0, at_quaternion = 3, at_velocity = 7, at_angular = 10, at_modes = 13;

/// Where the load acts: at the bracket's load point, or on a part.
enum class LoadOn { bracket, mobile, fixed };

/// What parameter sets that are evaluated together have in common, with the constants of all:
/// body (see at_… below), then each mode, then each connection with its three axes (models/axis_terms.hpp).
template <class T>
struct MountKernel {
    const T* constants = nullptr;
    const AxisShape* shapes = nullptr;  ///< 3 · connections
    int connections = 0;
    int modes = 0;            ///< that are free; none where the fixed part's motion is prescribed
    int at_connections = 0;   ///< their first constant
    bool prescribed = false;  ///< the fixed part moves as the drive says
    LoadOn load_on = LoadOn::bracket;
};

/// Constants of the body: 1/mass, inertia and its inverse (by columns), spin, gravity, load point from the CoG (mobile
/// part) or from F's origin.
inline constexpr int at_inverse_mass = 0, at_inertia = 1, at_inverse_inertia = 10, at_spin = 19, at_gravity = 22,
                     at_load_arm = 25, body_constants = 28;
/// Constants of a mode: translation, rotation, at the load point, base participation, 2 ζ ω, ω².
inline constexpr int at_translation = 0, at_rotation = 3, at_load = 6, at_base = 9, at_mode_damping = 12,
                     at_mode_stiffness = 13, mode_constants = 14;
/// Constants of a connection before those of its axes: position, position from the CoG.
inline constexpr int connection_constants = 6;

/// What acts from outside at one time.
template <class T>
struct Forcing {
    Vec3<T> load, base;  ///< N, m/s², in G
    T elapsed = 0.0;     ///< s
    Mat3<T> R_GF;        ///< the fixed part's motion where it is prescribed
    Vec3<T> p_GF, w_GF, v_GF;
};

/// The branch of each kink that holds, in the order of the axes.
template <class T>
struct Regime {
    const T* closed;            ///< of each stop: 1 in contact, otherwise 0
    const T* direction;         ///< of each bristle: ±1
    const T *anchor, *stretch;  ///< of each bristle: q (m) and its stretch (m) there
};

/// Relative displacement and velocity of each axis, stretch of each bristle.
template <class T>
struct AxisMotion {
    T *q, *v, *stretch;
};

/// a = (1 − cos φ)/φ², b = (φ − sin φ)/φ³ for s = φ², by their series: 1e-16 up to φ = 0.7, 1e-9 at 2.
template <class T>
inline void calcTurnCoefficients(const T& s, T& a, T& b) {
    a = T(0.5) -
        s * T(1.0 / 24) *
            (T(1.0) -
             s * T(1.0 / 30) *
                 (T(1.0) - s * T(1.0 / 56) *
                               (T(1.0) - s * T(1.0 / 90) * (T(1.0) - s * T(1.0 / 132) * (T(1.0) - s * T(1.0 / 182))))));
    b = T(1.0 / 6) -
        s * T(1.0 / 120) *
            (T(1.0) - s * T(1.0 / 42) *
                          (T(1.0) - s * T(1.0 / 72) *
                                        (T(1.0) - s * T(1.0 / 110) *
                                                      (T(1.0) - s * T(1.0 / 156) * (T(1.0) - s * T(1.0 / 210))))));
}

template <class T>
inline Mat3<T> rotationFromQuaternion(const T* e) {
    const T s = T(2.0) / (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    const T xx = s * e[1] * e[1], yy = s * e[2] * e[2], zz = s * e[3] * e[3];
    const T xy = s * e[1] * e[2], xz = s * e[1] * e[3], yz = s * e[2] * e[3];
    const T wx = s * e[0] * e[1], wy = s * e[0] * e[2], wz = s * e[0] * e[3];
    return {{T(1.0) - yy - zz, xy + wz, xz - wy},
            {xy - wz, T(1.0) - xx - zz, yz + wx},
            {xz + wy, yz - wx, T(1.0) - xx - yy}};
}

/// Pose and velocity of the fixed part, with the left Jacobian B of its rotation where modes move it.
template <class T>
struct FixedPart {
    Mat3<T> R, B;
    Vec3<T> p, w, v;
};

template <class T>
inline FixedPart<T> calcFixedPart(const MountKernel<T>& kernel, const T* y, const Forcing<T>& forcing) {
    if (kernel.prescribed) return {forcing.R_GF, {}, forcing.p_GF, forcing.w_GF, forcing.v_GF};
    FixedPart<T> fixed;
    Vec3<T> theta, theta_dot;
    const T* mode = kernel.constants + body_constants;
    for (int j = 0; j < kernel.modes; ++j, mode += mode_constants) {
        const T &eta = y[at_modes + j], &eta_dot = y[at_modes + kernel.modes + j];
        const Vec3<T> translation = Vec3<T>::load(mode + at_translation), rotation = Vec3<T>::load(mode + at_rotation);
        fixed.p = fixed.p + eta * translation;
        fixed.v = fixed.v + eta_dot * translation;
        theta = theta + eta * rotation;
        theta_dot = theta_dot + eta_dot * rotation;
    }
    T a{}, b{};
    calcTurnCoefficients(dot(theta, theta), a, b);
    // B = 1 + a K + b K², R = 1 + K B, with K the cross matrix of θ; by columns.
    const auto turn = [&](const Vec3<T>& unit, Vec3<T>& of_B, Vec3<T>& of_R) {
        const Vec3<T> K = cross(theta, unit);
        of_B = unit + a * K + b * cross(theta, K);
        of_R = unit + cross(theta, of_B);
    };
    turn({1.0, 0.0, 0.0}, fixed.B.x, fixed.R.x);
    turn({0.0, 1.0, 0.0}, fixed.B.y, fixed.R.y);
    turn({0.0, 0.0, 1.0}, fixed.B.z, fixed.R.z);
    fixed.w = fixed.B * theta_dot;
    return fixed;
}

/// Sum of the connections' forces on the fixed part, in its axes, and their moment about the CoG.
template <class T>
struct MountSum {
    Vec3<T> force, moment;
};

/// @param p, v of the CoG from F's origin, @param R, w of M relative to F; all in F axes
template <class T>
inline MountSum<T> calcConnections(const MountKernel<T>& kernel, const Mat3<T>& R, const Vec3<T>& p, const Vec3<T>& w,
                                   const Vec3<T>& v, const T& elapsed, const T* z, const Regime<T>& regime, T* zdot,
                                   const AxisMotion<T>& motion) {
    const T* c = kernel.constants + kernel.at_connections;
    const AxisShape* shape = kernel.shapes;
    const T* closed = regime.closed;
    T *q = motion.q, *rate = motion.v;
    int bristle = 0;
    MountSum<T> sum;
    for (int i = 0; i < kernel.connections; ++i) {
        const Vec3<T> arm = R * Vec3<T>::load(c + 3);
        (p + arm - Vec3<T>::load(c)).store(q);
        (v + cross(w, arm)).store(rate);
        c += connection_constants;
        T f[3];
        for (int k = 0; k < 3; ++k, ++shape, ++q, ++rate) {
            T states[kMostStates];
            const T* direction = regime.direction + bristle;
            const int count = shape->stateCount();
            for (int b = 0; b < shape->branches; ++b) states[b] = z[b];
            for (int d = 0; d < shape->draggedCount(); ++d, ++bristle) {
                motion.stretch[bristle] = calcDragged(*shape, c, d, regime.direction[bristle], regime.stretch[bristle],
                                                      *q - regime.anchor[bristle]);
                states[shape->branches + d] = motion.stretch[bristle];
            }
            f[k] = calcAxisForce(
                *shape, c, [&](int s, const T&) { return closed[s]; }, *q, *rate, elapsed, states);
            if (count > 0) {
                calcAxisStateRates(*shape, c, direction, *q, *rate, states, zdot);
                z += count;
                zdot += count;
            }
            closed += shape->stops;
            c += shape->constantCount();
        }
        const Vec3<T> force = Vec3<T>::load(f);
        sum.force = sum.force + force;
        sum.moment = sum.moment + cross(arm, force);
    }
    return sum;
}

/// Rates of the whole state, and the motion of each axis on the way.
template <class T>
inline void calcRates(const MountKernel<T>& kernel, const T* y, const Forcing<T>& forcing, const Regime<T>& regime,
                      T* rates, const AxisMotion<T>& motion) {
    const T* body = kernel.constants;
    const Mat3<T> R_GM = rotationFromQuaternion(y + at_quaternion);
    const Vec3<T> position = Vec3<T>::load(y + at_position), velocity = Vec3<T>::load(y + at_velocity);
    const Vec3<T> w = Vec3<T>::load(y + at_angular);
    const int modes = kernel.modes;
    const T* z = y + at_modes + 2 * modes;
    T* zdot = rates + at_modes + 2 * modes;
    MountSum<T> sum;
    Vec3<T> force;   // on the fixed part, in G
    Vec3<T> moment;  // on the mobile part about the CoG, in M
    FixedPart<T> fixed;
    if (kernel.prescribed || modes > 0) {
        fixed = calcFixedPart(kernel, y, forcing);
        const Mat3<T> R_FM{transposed(fixed.R, R_GM.x), transposed(fixed.R, R_GM.y), transposed(fixed.R, R_GM.z)};
        const Vec3<T> arm = position - fixed.p;
        sum = calcConnections(kernel, R_FM, transposed(fixed.R, arm), R_FM * w - transposed(fixed.R, fixed.w),
                              transposed(fixed.R, velocity - fixed.v - cross(fixed.w, arm)), forcing.elapsed, z, regime,
                              zdot, motion);
        force = fixed.R * sum.force;
        moment = T(-1.0) * transposed(R_FM, sum.moment);
        sum.moment = fixed.R * sum.moment + cross(arm, force);  // about F's origin, in G
    } else {
        sum = calcConnections(kernel, R_GM, position, R_GM * w, velocity, forcing.elapsed, z, regime, zdot, motion);
        force = sum.force;
        moment = T(-1.0) * transposed(R_GM, sum.moment);
    }
    Vec3<T> on_mobile = T(-1.0) * force, load = forcing.load;
    if (kernel.load_on == LoadOn::mobile) {
        on_mobile = on_mobile + load;
        moment = moment + cross(Vec3<T>::load(body + at_load_arm), transposed(R_GM, load));
    } else if (kernel.load_on == LoadOn::fixed && modes > 0) {
        force = force + load;
        sum.moment = sum.moment + cross(fixed.R * Vec3<T>::load(body + at_load_arm), load);
    }
    velocity.store(rates + at_position);
    const T* e = y + at_quaternion;
    T* e_dot = rates + at_quaternion;
    e_dot[0] = T(-0.5) * (e[1] * w.x + e[2] * w.y + e[3] * w.z);
    e_dot[1] = T(0.5) * (e[0] * w.x + e[2] * w.z - e[3] * w.y);
    e_dot[2] = T(0.5) * (e[0] * w.y + e[3] * w.x - e[1] * w.z);
    e_dot[3] = T(0.5) * (e[0] * w.z + e[1] * w.y - e[2] * w.x);
    (body[at_inverse_mass] * on_mobile + Vec3<T>::load(body + at_gravity) - forcing.base).store(rates + at_velocity);
    const Vec3<T> momentum = Mat3<T>::load(body + at_inertia) * w + Vec3<T>::load(body + at_spin);
    (Mat3<T>::load(body + at_inverse_inertia) * (moment - cross(w, momentum))).store(rates + at_angular);
    if (modes == 0) return;
    const Vec3<T> torque = transposed(fixed.B, sum.moment);
    const T* mode = body + body_constants;
    for (int j = 0; j < modes; ++j, mode += mode_constants) {
        const T &eta = y[at_modes + j], &eta_dot = y[at_modes + modes + j];
        rates[at_modes + j] = eta_dot;
        T acceleration = dot(Vec3<T>::load(mode + at_translation), force) +
                         dot(Vec3<T>::load(mode + at_rotation), torque) -
                         dot(Vec3<T>::load(mode + at_base), forcing.base) - mode[at_mode_damping] * eta_dot -
                         mode[at_mode_stiffness] * eta;
        if (kernel.load_on == LoadOn::bracket) acceleration += dot(Vec3<T>::load(mode + at_load), load);
        rates[at_modes + modes + j] = acceleration;
    }
}

}  // namespace wems::identify
