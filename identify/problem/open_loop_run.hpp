/// @file
/// The measured motion of one run as the open-loop equations need it: smoothed, decimated, with its derivatives.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "identify/problem/run_filter.hpp"
#include "identify/problem/velocity_noise.hpp"
#include "models/axis_law.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

// The mount as a linear system about its rest position: 6 x 6 matrices about M's origin, translation above rotation.

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix6 calcMassMatrix(const MobileBody& body);
/// Of the elastomers alone: stops and what else the laws hold left out.
Matrix6 calcStiffnessMatrix(const MountModel& model);
/// Hz: the highest natural frequency of the mobile part with each axis in its stiffest stop, the fixed part at rest;
/// 0 without stops.
double calcContactFrequency(const MountModel& model);
/// Of the mobile part's six motions: 1 where it is free, 0 where a guide holds it. A guide gives whatever force it
/// must: the equations of held motions say nothing of the mount.
Vector6 calcFreedom(const MobileBody& body);
/// Rows and columns of held motions become those of `diagonal` times one.
void holdMotions(Matrix6& matrix, const Vector6& freedom, double diagonal);
/// (displacement of an axis) = directionᵀ (translation, rotation): (e_a ; r_i × e_a).
Vector6 calcAxisDirection(const MountModel& model, int connection, int axis);

/// One rigid part; column k belongs to sample k. In G.
struct SmoothPart {
    Eigen::Matrix3Xd p, theta;  ///< m, rad (rotation vector)
    Eigen::Matrix3Xd v, w;      ///< m/s, rad/s
    Eigen::Matrix3Xd a, alpha;  ///< m/s², rad/s²
    std::vector<Eigen::Matrix3d> R;
};

/// Every quantity went through the same low-pass filter, so that the equations hold between them.
struct OpenLoopRun {
    std::string file;
    double interval = 0;      ///< s, after decimation
    double raw_interval = 0;  ///< s, of the recording
    double pass = 0;          ///< Hz, all is flat up to here
    double lowest = 0;        ///< Hz, below this the motion is not known
    ExcitedBand band;         ///< Hz
    RunFilter filter;
    Eigen::VectorXd time;  ///< s since the start of the recording
    SmoothPart mobile, fixed;
    AxisSeries q, v;        ///< relative displacement and velocity, F axes: row 3 i + axis; m, m/s
    QuietVelocities quiet;  ///< v without what is noise in a stretch and a band
    Eigen::Matrix3Xd load;  ///< N; empty if not recorded
    Eigen::Matrix3Xd base;  ///< m/s²; empty if not recorded
    Eigen::VectorXd swept;  ///< Hz at each sample; empty if not known
    bool fixed_measured = false;
    /// A part's displacements are integrated accelerations: its slow motion is not known.
    bool mobile_integrated = false, fixed_integrated = false;
    /// What was taken off each part's displacements before they were filtered (fast_motion.hpp): translation above
    /// rotation, at the recording's samples; empty where nothing was.
    Eigen::MatrixXd mobile_folded, fixed_folded;
    Eigen::VectorXd taper;  ///< 0 where the filter met an end, 1 inside, smooth between
    /// Noise of one channel as displacement, white up to 1/(2 raw_interval) (m RMS) and the acceleration noise fused
    /// with it (m/s² RMS, infinite if accelerations were not recorded).
    double mobile_noise = 0, fixed_noise = 0;
    double mobile_acceleration_noise = 0, fixed_acceleration_noise = 0;
    /// Covariance of the accelerations by folding (origin above rotation, mobile above fixed part), white likewise.
    Eigen::Matrix<double, 12, 12> aliasing = Eigen::Matrix<double, 12, 12>::Zero();

    int sampleCount() const { return static_cast<int>(time.size()); }
    bool integrated() const { return mobile_integrated || fixed_integrated; }
};

/// @param swept_frequency Hz at each sample of `run`, empty if it is not known
OpenLoopRun makeOpenLoopRun(const RunMotion& run, const MountModel& model, const ExcitedBand& band,
                            const Eigen::VectorXd& swept_frequency);

/// Relative displacement and velocity of every axis from the motion of both parts (rows 3 i + axis).
void calcRelative(const MountModel& model, const SmoothPart& mobile, const SmoothPart& fixed, AxisSeries& q,
                  AxisSeries& v);

// What small motion about a measured one meets of a law: its equivalent linear stiffness, and how that comes and goes.

/// In the mean over a run: κ(ω) = k + iωc − Σ_b k_b / (1 + iωτ_b), k with the branches' springs at work and the stops
/// as long as they touch. Dry friction is left out: the equations take a velocity without noise for it.
struct DynamicStiffness {
    double stiffness = 0;  ///< N/m
    double damping = 0;    ///< N s/m
    std::vector<MaxwellBranch> branches;

    std::complex<double> at(double w) const;
};

/// @param row of the axis in q and v: 3 connection + axis
DynamicStiffness calcDynamicStiffness(const OpenLoopRun& run, AxisLaw law, Eigen::Index row);

/// Static stiffness along the run, N/m, that of the stops as band_limited_force.hpp has it.
Eigen::VectorXd calcTangent(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row);
/// The same beyond its mean, N/m: zero where no stop touches and the law is linear.
Eigen::RowVectorXd calcStiffnessFluctuation(const OpenLoopRun& run, const AxisLaw& law, Eigen::Index row);

}  // namespace wems::identify
