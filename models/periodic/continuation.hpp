/// @file
/// Following the solutions of a harmonic balance over frequency, around its folds: pseudo-arclength continuation.
///
/// A step goes along the tangent of the curve (Q, f) and comes back to it by Newton's method across the tangent; both
/// are counted in units of a typical amplitude and of a tenth of the band. Axes whose law adds nothing along the motion
/// are eliminated, so that only stops that are touched cost. Source: Keller (1977); Allgower, Georg, Introduction to
/// Numerical Continuation Methods (2003), doi:10.1137/1.9780898719154.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "models/periodic/harmonic_balance.hpp"

namespace wems {

struct ContinuationSettings {
    double from = 0, to = 0;          ///< Hz; the curve starts at `from` and ends where it leaves the band
    double longest_step = 1.0 / 150;  ///< of the band, in frequency; as much of the typical amplitude times 20
    int most_points = 4000;
};

/// A solution and the direction in which the curve goes on, in units of the typical amplitude and a tenth of the band.
struct CurvePoint {
    Eigen::VectorXd Q;        ///< m
    double frequency = 0;     ///< Hz
    Eigen::VectorXd along_Q;  ///< with along_frequency of length 1
    double along_frequency = 0;
    double length = 0;  ///< of the curve up to here
};

class Continuation {
public:
    Continuation(const HarmonicBalance& balance, const ContinuationSettings& settings);

    double frequencyUnit() const { return frequency_unit_; }  ///< Hz
    double amplitudeUnit() const { return amplitude_unit_; }  ///< m

    /// Calls `visit` with every point; it returns false to stop. @return why the curve ends before it has crossed the
    /// band; empty if it has
    std::string follow(const std::function<bool(const CurvePoint&)>& visit) const;

    /// Newton at a fixed frequency from Q on. @return whether it converged
    bool solveAt(double frequency, Eigen::VectorXd& Q) const;

private:
    struct Step {
        Eigen::VectorXd Q;
        double frequency;
    };
    /// Solves J δQ + r δf = right_Q, w·(δQ, δf) = right_f, the border w in units.
    Step solveBordered(const HarmonicBalance::Linear& linear, const HarmonicBalance::Nonlinear& nonlinear,
                       const Eigen::VectorXd& by_frequency, const CurvePoint& border, const Eigen::VectorXd& right_Q,
                       double right_f) const;
    Eigen::VectorXd calcResidual(const Eigen::VectorXd& Q, double frequency) const;
    Eigen::VectorXd differentiateByFrequency(const Eigen::VectorXd& Q, double frequency) const;
    void setTangent(const CurvePoint& before, CurvePoint& point) const;
    int correct(const CurvePoint& border, CurvePoint& point) const;

    const HarmonicBalance& balance_;
    ContinuationSettings settings_;
    double frequency_unit_, amplitude_unit_;
};

}  // namespace wems
