/// @file
/// The force law of one axis of a connection: elastomer, stops, and every mechanism that a diagnosis may add.
///
/// With q the relative displacement (m) from rest, v = dq/dt (m/s), t the time since the start of the recording (s):
///
///     f(q, v, z, t) = k (1 + d t) q                      elastomer, drifting
///                   + k_q q^2 + k_c q^3                  smooth asymmetry, hardening or softening
///                   + curve(q)                           a measured force curve (models/force_curve.hpp)
///                   + c v                                dashpot
///                   + F tanh(v / v_t)                    dry friction (no presliding)
///                   + Σ_b g_b k (q − z_b)                Maxwell branches (relaxation, structural damping)
///                   + F_h s / Y                          hysteresis of Bouc and Wen
///                   + Σ_i slider force                   springs with gap and slider in series, see below
///                   + Σ_stops                            see below
///
/// A stop on side + with clearance c and its own stiffness k_s, the rest position being off the middle of the gap by
/// the offset o, is penetrated by δ = q + o − c; on side − by δ = −(q + o) − c. It adds, for δ > 0 only,
///
///     ± k_s δ max(0, 1 + χ δ')                           Hunt–Crossley with exponent 1, never pulls
///
/// Each Maxwell branch has one internal state z_b (m), the displacement of its dashpot: z_b' = (q − z_b) / τ_b.
/// `branches` are given one by one (a Prony series, g_b k = stiffness_b): a relaxation spectrum over any band. Those of
/// `spectrum` are given by their g_b, so that they follow the stiffness.
/// Structural damping with loss factor η is a set of branches whose loss modulus is nearly constant over
/// `structuralBand()`, the static stiffness lowered so that the storage modulus is k at the band's geometric middle.
/// The branches take that stiffness from the static one, so that η has an upper limit, `largestLossFactor()`.
///
/// Hysteresis has one internal state s (m), |s| ≤ Y, and depends on the path alone, not on its speed:
///
///     s' = v − β |v| |w|^(n−1) w − γ v |w|^n,   w = s / Y,   γ = 1 − β
///
/// It starts as a spring of stiffness F_h / Y and slides at F_h; n says how sharp the knee is. With the energy of that
/// spring, F_h s² / (2 Y), the power lost is F_h |w|^(n+1) (β |v| + γ v sign w), never negative if and only if β ≥ |γ|,
/// that is β ≥ 1/2. With less, a release gives back more than that spring holds, though from 0 on less than was put in.
/// At β = 1/2 unloading is as stiff as that spring, at β = 1 up to twice as stiff: the range of β.
///
/// A slider is a spring in series with a gap g and dry friction (a Jenkins element if g = 0; many in parallel are the
/// model of Iwan, and what an elastomer does whose stiffness falls with the amplitude). Its state e (m) is what spring
/// and gap are stretched by; with w = e / (Y + g/2) and the exponent n
///
///     e' = v (1 − w^n) for w v ≥ 0, otherwise e' = v;   force = F₊ (e − g/2) / Y     e > g/2
///                                                               0                    |e| ≤ g/2
///                                                               F₋ (e + g/2) / Y     e < −g/2
///
/// so that it slides at F₊ towards + and at −F₋ towards −. Without exponent the knee is a corner. The power lost is
/// force · (v − e') ≥ 0: no closed cycle gives energy.
///
/// Sign: f is the force that the law opposes to q, so that f = +k q; the mobile part receives −f.
/// Continuity: f is C⁰ in q (C¹ but at the stops) and C⁰ in v; the derivatives at a kink are those from outside the
/// stop. Sources: trilinear law, Noël, Kerschen, Newerla (IMAC XXX, 2012), eq. (11); Hunt, Crossley (1975),
/// doi:10.1115/1.3423596; Wen (1976), doi:10.1061/JMCEA3.0002106; parallel sliders, Iwan
/// (1966), doi:10.1115/1.3625199; play, Krasnosel'skii, Pokrovskii, Systems with Hysteresis (1989); generalized Maxwell
/// model, Lakes, Viscoelastic Materials (2009), ch. 2.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "models/axis_terms.hpp"
#include "models/force_curve.hpp"

namespace wems {

enum class Side { positive, negative };

/// A mechanical stop with clearance.
struct Stop {
    Side side = Side::positive;
    double clearance = 0;  ///< m, > 0, from the middle of the gap
    double stiffness = 0;  ///< N/m, the stop's own, added to the elastomer's; negative values describe a softening law
    double dissipation = 0;  ///< χ, s/m, ≥ 0
};

/// One Maxwell branch (Zener solid together with the elastomer).
struct Relaxation {
    double stiffness_ratio = 0;  ///< branch stiffness over the static one, ≥ 0
    double time_constant = 0;    ///< s, > 0
};

/// Dry friction. Without `presliding_stiffness` F tanh(v / v_t). With it, an elasto-plastic (Dahl/Prandtl-like) law
/// with one internal state, the bristle deflection s (m): force σ s, s' = v (1 − sign(v) σ s / F), |σ s| ≤ F.
struct Friction {
    double force = 0;                            ///< F, N, ≥ 0, the sliding level
    double transition_velocity = 1e-3;           ///< v_t, m/s, > 0
    std::optional<double> presliding_stiffness;  ///< σ, N/m, > 0
};

/// Smooth hysteresis, the law of Bouc and Wen: of wire-rope and elastomer mounts, bolted joints.
struct Hysteresis {
    double force = 0;                  ///< F_h, N, ≥ 0, the sliding level
    double yield_displacement = 1e-4;  ///< Y, m, > 0, from zero force to sliding if the knee were sharp
    double exponent = 1;               ///< n, 1 to `sharpest`: large means a sharp knee
    double shape = 0.5;                ///< β, 0.5 to 1

    /// Here the knee is sharp: within 1.4 % of F_h of a spring that slides at once. Sharper ones only cost time.
    static constexpr double sharpest = 50;
};

/// One Maxwell branch: stiffness (N/m, ≥ 0) and time constant (s, > 0).
struct MaxwellBranch {
    double stiffness = 0;
    double time_constant = 0;
};

/// Spring, gap and dry friction in series.
struct Slider {
    double force = 0;                      ///< F₊, N, ≥ 0, the sliding level towards +
    double yield_displacement = 1e-4;      ///< Y, m, > 0, stretch of the spring where it slides
    double gap = 0;                        ///< g, m, ≥ 0
    std::optional<double> negative_force;  ///< F₋, N, ≥ 0; absent: F₊
    std::optional<double> exponent;        ///< n, 1 to `Hysteresis::sharpest`; absent: a corner
};

/// All that acts along one mount axis of one connection. Default-constructed: no force at all.
struct AxisLaw {
    double stiffness = 0;    ///< k, N/m, ≥ 0
    double damping = 0;      ///< c, N s/m, ≥ 0
    double offset = 0;       ///< o, m, rest position minus the middle of the gap
    double quadratic = 0;    ///< k_q, N/m^2: stiffer towards + than towards −, by 4 k_q |q|
    double cubic = 0;        ///< k_c, N/m^3
    double loss_factor = 0;  ///< η, -, ≥ 0
    double drift = 0;        ///< d, 1/s
    std::optional<Relaxation> relaxation;
    std::optional<Friction> friction;
    std::optional<Hysteresis> hysteresis;
    std::vector<MaxwellBranch> branches;  ///< besides those of relaxation and loss factor, `kMostBranches` at most
    std::vector<Relaxation> spectrum;     ///< likewise, as parts of the stiffness; with `branches` so many at most
    std::vector<Slider> sliders;          ///< `kMostSliders` at most
    std::vector<CurveRow> curve;          ///< adds to the elastomer; empty: none
    std::vector<Stop> stops;
};

/// Gives the slope that a curve has at rest, where it is one that pushes back, to the stiffness: what scales with the
/// stiffness, and tolerances of it, then act on that slope.
void moveSlopeToStiffness(AxisLaw& law);

/// First key (relative to the axis table, such as `stops[1].clearance`) whose value is out of its range, with the
/// value and the range; nullopt if the law is usable.
struct LawProblem {
    std::string key;
    std::string problem;
    std::string accepted;
};
std::optional<LawProblem> findProblem(const AxisLaw& law);

/// Frequencies (Hz) between which structural damping has a nearly constant loss factor.
struct Band {
    double lower, upper;
};
Band structuralBand();
/// Loss factors from here on would leave no static stiffness.
double largestLossFactor();

/// An axis law prepared for evaluation: derived constants computed once. Cheap to evaluate, no allocation.
class AxisForce {
public:
    explicit AxisForce(const AxisLaw& law);

    const AxisLaw& law() const { return law_; }

    /// Number of internal states: Maxwell branches first, then the bristle deflection if friction has presliding, then
    /// that of the hysteresis, then those of the sliders.
    int stateCount() const { return shape_.stateCount(); }

    /// f (N). @param z stateCount() internal states (m), may be null if there are none.
    double calcForce(double q, double v, double t, const double* z) const;

    /// ∂f/∂q and ∂f/∂v at fixed states, N/m and N s/m.
    double calcStiffness(double q, double v, double t, const double* z) const;
    double calcDamping(double q, double v, double t, const double* z) const;

    /// Recoverable energy (J): elastomer, cubic term, curve, stops, springs of the branches, bristle, hysteresis and
    /// sliders.
    double calcPotential(double q, double t, const double* z) const;

    /// Power lost to heat (W), ≥ 0: f v − d/dt potential, the explicit time dependence (drift) excluded.
    double calcDissipatedPower(double q, double v, double t, const double* z) const;

    /// z' into `zdot` (m/s).
    void calcStateDerivative(double q, double v, const double* z, double* zdot) const;

    /// What motion drags along, bristle, hysteresis and sliders, depends on the path alone: moves its states `z` (all
    /// of the law) by the travel (m) of a motion in one direction.
    void dragStates(double travel, double* z) const;
    /// Stiffness (N/m) of what is dragged, for motions about rest too small for it to slide. What has a gap has none
    /// there; `largest`: beyond its gap, too.
    double draggedStiffness(bool largest = false) const;

    /// The static part alone: elastomer with its static stiffness at t = 0, cubic term, curve, stops; states relaxed.
    double calcStaticForce(double q) const;
    double calcStaticStiffness(double q) const;

    const std::vector<MaxwellBranch>& branches() const { return branches_; }
    const ForceCurve& curve() const { return curve_; }

    /// The law as models/axis_terms.hpp evaluates it.
    const AxisShape& shape() const { return shape_; }
    const std::vector<double>& constants() const { return constants_; }

private:
    // A stop along its own direction: δ = direction · (q + o) − c.
    struct Contact {
        double direction, clearance, stiffness, dissipation;
    };
    // Penetration if there is contact, otherwise not positive.
    double calcPenetration(const Contact& stop, double q) const {
        return stop.direction * (q + law_.offset) - stop.clearance;
    }
    // Static elastomer stiffness, drift included: the drift changes the static part by d t k.
    double calcElastomerStiffness(double t) const { return static_stiffness_ + law_.stiffness * law_.drift * t; }

    void collectConstants();
    const double* hysteresisConstants(int i) const { return constants_.data() + shape_.hysteresisConstants(i); }

    AxisLaw law_;
    AxisShape shape_;
    std::vector<double> constants_;
    std::vector<MaxwellBranch> branches_;
    std::vector<Contact> contacts_;
    ForceCurve curve_;
    double static_stiffness_ = 0;
    double friction_force_ = 0, transition_velocity_ = 1, presliding_stiffness_ = 0;
};

// Maxwell branches whose loss modulus is nearly constant over a band: structural damping in the time domain.
//
// A branch of stiffness g with time constant τ has, at the angular frequency ω and with u = ω τ, the storage modulus
// g u²/(1 + u²) and the loss modulus g u/(1 + u²). Three branches with corner frequencies f_m/κ, f_m, κ f_m, where f_m
// is the geometric middle of the band, and stiffnesses by linear least squares over the band (41 frequencies, equally
// spaced in log f) give a loss modulus of 1 within 0.2 % over one decade. κ = 4.89 is where that ripple is smallest:
// the outer corners lie a factor 1.55 outside of the band.

/// The branches for a loss modulus of 1 N/m in the middle of structuralBand().
struct StructuralBranches {
    std::array<MaxwellBranch, 3> branch;
    double storage_in_middle = 0;  ///< storage modulus of all branches there, N/m
};
const StructuralBranches& structuralBranches();

}  // namespace wems
