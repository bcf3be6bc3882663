/// @file
/// Following the solutions of a harmonic balance over the frequency, or over the level at one frequency, around folds:
/// pseudo-arclength continuation.
///
/// A step goes along the tangent of the curve (Q, p) and comes back to it by Newton's method across the tangent; both
/// are counted in units of a typical amplitude and of a tenth of the range of p. Axes whose law adds nothing along the
/// motion are eliminated, so that only stops that are touched cost. Source: Keller (1977); Allgower, Georg,
/// Introduction to Numerical Continuation Methods (2003), doi:10.1137/1.9780898719154.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "models/periodic/harmonic_balance.hpp"

namespace wems {

struct ContinuationSettings {
    double from = 0, to = 0;  ///< of the parameter: Hz, or levels as factors of the system's input
    /// Hz; then the parameter is the level, at this frequency. Absent: the parameter is the frequency.
    std::optional<double> at_frequency = std::nullopt;
    double longest_step = 1.0 / 150;  ///< of the range, in the parameter; as much of the typical amplitude times 20
    /// How far the straight line between two points may pass the curve, as a part of an axis' amplitude; where the
    /// curve is steep, a tenth of that part of the parameter suffices. Absent: any distance.
    std::optional<double> largest_gap = std::nullopt;
    int most_points = 4000;
};

/// A solution and the direction in which the curve goes on, in units of the typical amplitude and a tenth of the range.
struct CurvePoint {
    Eigen::VectorXd Q;        ///< m
    double parameter = 0;     ///< Hz, or -
    Eigen::VectorXd along_Q;  ///< with along_parameter of length 1
    double along_parameter = 0;
    double length = 0;  ///< of the curve up to here
};

class Continuation {
public:
    Continuation(const HarmonicBalance& balance, const ContinuationSettings& settings);

    double parameterUnit() const { return parameter_unit_; }  ///< Hz, or -
    double amplitudeUnit() const { return amplitude_unit_; }  ///< m

    /// Calls `visit` with every point; it returns false to stop.
    using Visit = std::function<bool(const CurvePoint&)>;
    /// From the linear response at `from` on. @return why the curve ends before it has crossed the range; empty if it
    /// has
    std::string follow(const Visit& visit) const;
    /// From a solution on, both ways unless the curve comes back to it. The points come in the order of the curve.
    /// @return as above; empty also if the curve is closed
    std::string followFrom(const Eigen::VectorXd& Q, double parameter, const Visit& visit) const;

    /// Newton at a fixed parameter from Q on. @return whether it converged
    bool solveAt(double parameter, Eigen::VectorXd& Q) const;

private:
    struct Step {
        Eigen::VectorXd Q;
        double parameter;
    };
    double frequencyAt(double parameter) const { return settings_.at_frequency.value_or(parameter); }
    HarmonicBalance::Linear linearAt(double parameter) const;
    /// Solves J δQ + r δp = right_Q, w·(δQ, δp) = right_p, the border w in units.
    Step solveBordered(const HarmonicBalance::Linear& linear, const HarmonicBalance::Nonlinear& nonlinear,
                       const Eigen::VectorXd& by_parameter, const CurvePoint& border, const Eigen::VectorXd& right_Q,
                       double right_p) const;
    Eigen::VectorXd calcResidual(const Eigen::VectorXd& Q, double parameter) const;
    Eigen::VectorXd differentiateByParameter(const Eigen::VectorXd& Q, double parameter) const;
    /// The linear response at the start of the range, or what follows from it at growing level.
    bool findStart(Eigen::VectorXd& Q) const;
    CurvePoint startAt(const Eigen::VectorXd& Q, double parameter) const;
    void setTangent(const CurvePoint& before, CurvePoint& point) const;
    int correct(const CurvePoint& border, CurvePoint& point) const;
    /// How far the straight line between two points passes the curve, over what is allowed.
    double calcGap(const CurvePoint& a, const CurvePoint& b) const;
    double distance(const CurvePoint& a, const CurvePoint& b) const;
    /// @param[out] closed whether the curve came back to where it began
    std::string walk(CurvePoint point, const Visit& visit, bool* closed) const;

    const HarmonicBalance& balance_;
    ContinuationSettings settings_;
    std::optional<HarmonicBalance::Linear> fixed_;  // at the one frequency, level 1
    double parameter_unit_, amplitude_unit_;
};

// Response curves that are not connected with the low end of the band (detached resonances, isolas).
//
// At one frequency the amplitude over the level is a curve of its own, which at most frequencies leads from rest
// through all motions: up, around folds, back and up again. It is followed to a multiple of the level, at the folds of
// the curves that are known and at frequencies all over the band. Where it passes the level, a motion that lies on no
// known curve belongs to a detached one. Source: the level curves ("S-curves") of Renson, Shaw, Barton, Neild (2019),
// doi:10.1016/j.ymssp.2018.09.012, computed here in place of measured.

struct DetachedSearch {
    double from = 0, to = 0;      ///< Hz
    double highest_level = 4;     ///< of the level curves, over the level that is asked for
    int frequencies = 16;         ///< over the band, besides those of the folds
    std::size_t most_curves = 8;  ///< that are followed
};

struct DetachedCurve {
    std::vector<CurvePoint> points;
    std::string incomplete;  ///< why it ends within the band without having closed; empty otherwise
};

/// @param along over the frequency, as the known curve was followed
/// @param known the points of the curve from the low end of the band
/// @param folds Hz, of that curve
std::vector<DetachedCurve> findDetachedCurves(const HarmonicBalance& balance, const Continuation& along,
                                              const std::vector<CurvePoint>& known, const std::vector<double>& folds,
                                              const DetachedSearch& search);

}  // namespace wems
