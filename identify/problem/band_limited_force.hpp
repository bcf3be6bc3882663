/// @file
/// Forces that bend or jump between samples, as the signals that the low pass of a run would have made of them.
///
/// A stop bends its force where it is reached, dry friction jumps where the motion turns. Sampled at points such a
/// force folds: its values depend on where the event falls between two samples. An edge of a stop errs by an impulse
/// B₂(θ) k_s v h²/2 (Euler–Maclaurin, B₂(θ) = θ² − θ + 1/6, 0.07 in the RMS over all places θ), which spreads over all
/// frequencies; at 1 kHz and 0.3 m/s a stop of 400 kN/m makes 4.5e-3 N s of that, twice what 2 µm of noise make of a
/// contact of 10 ms. The mean over the interval around each sample takes what folds down by f h at a frequency f; what
/// the mean takes from a smooth signal, h²/24 of its second derivative, is put back.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/axis_law.hpp"

namespace wems::identify {

/// tanh(v/v_t) at the samples, with v linear between samples. At a reversal it jumps within v_t/a, far less than an
/// interval.
/// @param v velocity at samples, m/s
/// @param transition_velocity v_t, m/s
Eigen::VectorXd calcSlidingDirection(const Eigen::VectorXd& v, double transition_velocity);

/// How that answers to a small change of the velocity: a reversal that comes earlier or later.
class SlidingDerivative {
public:
    SlidingDerivative() = default;
    /// About these velocities, as calcSlidingDirection has them.
    SlidingDerivative(const Eigen::VectorXd& v, double transition_velocity);
    /// @param v change of the velocity (m/s) at the samples
    Eigen::VectorXd apply(const Eigen::Ref<const Eigen::VectorXd>& v) const;

private:
    Eigen::Matrix3Xd weights_;  // of the sample before, the own, and the next, s/m
};

/// Force of the stops of a law (N, sign of q) at the samples, along the cubics through all samples with their
/// velocities.
/// @param q, v displacement (m) and velocity (m/s) at the samples; @param interval s
Eigen::VectorXd calcStopForce(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double interval);

/// Their static stiffness, N/m, the mean over the interval around each sample. It changes continuously with motion and
/// clearance, where that of the samples jumps as one of them comes into contact.
Eigen::VectorXd calcStopStiffness(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                  double interval);

/// How that force answers to a small change of the motion: the derivative of calcStopForce, dissipation and the places
/// of both edges of a contact included.
class StopDerivative {
public:
    StopDerivative() = default;
    /// About this motion, as calcStopForce has it.
    StopDerivative(const AxisLaw& law, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double interval);

    /// Change of the force (N) at the samples.
    /// @param q, v changes of displacement (m) and velocity (m/s) at the samples
    Eigen::VectorXd apply(const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& v) const;

private:
    /// Of an interval in which a stop is touched: what q0, h v0, q1, h v1 change in the means around both samples.
    struct Touch {
        Eigen::Index first;
        double weight[2][4];
    };
    std::vector<Touch> touches_;
    double interval_ = 0;
};

}  // namespace wems::identify
