/// @file
/// The six equations of motion of the mobile part along a measured run, in weak form, linear in the parameters.
///
/// About M's origin, all vectors in G (an inertial frame), c the centre of gravity and I the inertia about Mo, both
/// turned by R = R_GM, h the wheel's angular momentum, b_ia the wrench pattern of axis a of connection i:
///
///     force    m (p'' − g) + (m R c)''                              + Σ R_GF e_a f_ia       = 0
///     moment   m R c × (p'' − g) + (R I Rᵀ ω)' + (R h)'             + Σ ρ_i × R_GF e_a f_ia = 0,    ρ_i = R r_i
///
///     f_ia = k q + c q' + stops + what the model knows besides (cubic term, friction, hysteresis).
///
/// Both rows are averaged with a test function φ (below). Where accelerations were measured they enter as
/// they are; otherwise the derivatives are moved onto φ: p'' → φ''*p, (R I Rᵀ ω)' → φ''*(I θ) − φ'*(R I Rᵀ ω − I θ'),
/// q' b → −φ'*(b q) − φ*(b' q). Only small corrections, of second order in the rotation, use derived rates.
/// Nonlinear columns are formed sample by sample and averaged afterwards, so that no bias of smoothing enters a kink.
///
/// Source of the principle: weak-form SINDy, Messenger and Bortz (2021), doi:10.1137/20M1343166; Newton–Euler about a
/// point that is not the centre of gravity: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 2.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/fit/law_history.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

// The test function of the weak form: a compact, smooth weight that an equation of motion is averaged with, so that
// derivatives fall on the weight and not on measured signals.
//
// φ(t) = B(t/h)/h, B the centred quintic B-spline (support ±3, unit integral, C⁴). With φ* written for the average
// around each output time,
//
//     φ*x'  = −∫ φ'(s) x(t + s) ds,      φ*x'' = ∫ φ''(s) x(t + s) ds.
//
// h is a whole number of samples: the zeros of the transform sinc(f h)^6 then fall on the multiples of the sampling
// frequency, so that the sums reproduce polynomials up to degree five exactly, and a sine of frequency f up to a
// relative error of about 2 (f / f_s)^4.

class TestFunction {
public:
    /// @param knot_samples h in samples, ≥ 1
    /// @param interval     sample interval, s
    TestFunction(int knot_samples, double interval);

    int knotSamples() const { return knot_samples_; }
    double interval() const { return interval_; }
    /// Taps reach from −half() to +half() samples; index half() is the middle.
    int half() const { return half_; }
    /// Samples from one output to the next: close enough that no information in the pass band is lost.
    int stride() const;
    /// Outputs for a run of that many samples, the first centred on sample half().
    int outputCount(int samples) const;

    const std::vector<double>& value() const { return value_; }    ///< Δt φ
    const std::vector<double>& first() const { return first_; }    ///< Δt φ', 1/s
    const std::vector<double>& second() const { return second_; }  ///< Δt φ'', 1/s²

    /// Transform at frequency f (Hz): sinc(f h)^6.
    double response(double frequency) const;

private:
    int knot_samples_, half_;
    double interval_;
    std::vector<double> value_, first_, second_;
};

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Which column of the equations belongs to which coefficient.
struct ColumnLayout {
    int axes = 0;            ///< 3 × connections
    bool free_body = false;  ///< mass, first and second moments have columns of their own

    int known() const { return 0; }  ///< coefficient 1: everything that is not freed
    int mass() const { return 1; }
    int firstMoment(int j) const { return 2 + j; }  ///< m c_j, kg m
    int inertia(int j) const { return 5 + j; }      ///< about Mo: xx yy zz xy xz yz, kg m²
    int stiffness(int axis) const { return (free_body ? 11 : 1) + axis; }
    int damping(int axis) const { return stiffness(axis) + axes; }
    int count() const { return damping(axes); }
};

/// Coefficients of the columns for a model: the residual is columns · coefficients plus the stops.
Eigen::VectorXd makeCoefficients(const ColumnLayout& layout, const MountModel& model);
/// m c and the inertia about Mo (xx yy zz xy xz yz) of a body.
Eigen::Matrix<double, 9, 1> calcMoments(const MobileBody& body);

/// Samples in which an axis moved far enough for its stops to matter.
struct AxisHistory {
    std::vector<int> sample;
    std::vector<double> q;                             ///< m, the law's offset not included
    std::vector<double> v;                             ///< m/s
    Eigen::Matrix<double, 6, Eigen::Dynamic> pattern;  ///< force (3) and moment about Mo (3), in G, of a unit force
    double largest = 0, smallest = 0;                  ///< of q over the run, m
};

struct RunEquations {
    ColumnLayout layout;
    TestFunction test_function;
    int outputs = 0;
    RowMatrix columns;  ///< row 6 n + e: output n, equation e (force x y z in N, moment x y z in N m); mean removed
    std::vector<AxisHistory> axes;  ///< empty histories for axes without stops
};

/// @param free_body whether the body's parameters have columns of their own
RunEquations makeEquations(const RunMotion& motion, const MountModel& model, const TestFunction& test_function,
                           bool free_body);

// The columns of one stop in the equations of motion: few outputs are touched, so they are kept sparse.

/// Averages of a stop's force for 1 N/m and of its derivative to the clearance, at the outputs where they are not zero.
struct StopColumn {
    std::vector<int> output;                         ///< ascending
    Eigen::Matrix<double, 6, Eigen::Dynamic> value;  ///< one column for each of these outputs
    Eigen::Matrix<double, 6, Eigen::Dynamic> slope;  ///< ∂value/∂clearance, 1/m
    Vector6d value_mean = Vector6d::Zero();          ///< over all outputs of the run
    Vector6d slope_mean = Vector6d::Zero();
    double contact_share = 0;  ///< of all samples
};

/// @param history of the stop's axis; @param offset the law's; only `stop`'s side, clearance and dissipation count.
StopColumn makeStopColumn(const AxisHistory& history, const TestFunction& test_function, int outputs, const Stop& stop,
                          double offset);

/// Multiplies value and slope with `transform` (whitening).
void transform(StopColumn& column, const Matrix6d& transform);

/// Sums over all outputs of products, means removed.
struct StopProducts {
    double value_value = 0, value_slope = 0, slope_value = 0, slope_slope = 0;
};
StopProducts multiply(const StopColumn& a, const StopColumn& b, int outputs);

}  // namespace wems::identify
