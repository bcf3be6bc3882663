/// @file
/// The equation of motion of the rigid mobile part along a measured motion: what the motion demands minus what the
/// model's laws give. Nothing is simulated, so that nothing is chaotic.
///
/// Wrenches are 6 x samples, in G: force (N) above moment about the origin of M (N m). With c = R_GM p_MoBcm:
///
///     demand  = [ m (a_cm − g) ;  R I Rᵀ α + w × (R I Rᵀ w + R h) + c × m (a_cm − g) ]
///     residual = demand − load + Σ_i [ R_GF f_i ;  R_GM r_i × R_GF f_i ]          (the mobile part receives −f)
///
/// with the load that acts on the mobile part itself, if any (below).
///
/// Internal states of the laws (relaxation, structural damping, bristle, hysteresis) are integrated along the measured
/// motion from rest, exactly for cubic Hermite q(t).
#pragma once

#include <Eigen/Core>

#include "identify/problem/open_loop_run.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

// The recorded load where it acts: at the bracket's load point, or at a point of either part ([load] in the model).

/// The load with the model's gains, N, in G: 3 x samples. Empty if the recording has none.
Eigen::MatrixXd calcLoad(const OpenLoopRun& run, const MountModel& model);

/// True if the recorded load acts on the mobile part itself.
bool loadsMobilePart(const OpenLoopRun& run, const MountModel& model);

/// What a load (3 x samples) at a point is about its part's origin: force above moment, in G, 6 x samples.
Eigen::MatrixXd calcLoadWrench(const OpenLoopRun& run, const LoadPoint& point,
                               const Eigen::Ref<const Eigen::MatrixXd>& load);

/// The same of unit loads along the axes, at rest.
Eigen::Matrix<double, 6, 3> calcLoadArm(const LoadPoint& point);

/// Law of one axis along its measured motion, N, positive with q; what bends or jumps between samples as
/// band_limited_force.hpp has it.
Eigen::VectorXd calcAxisForce(const OpenLoopRun& run, const AxisLaw& law, int connection, int axis);

/// Adds the wrench that belongs to force `f` at an axis (the sign of the residual) to `wrench`.
void addAxisWrench(const OpenLoopRun& run, const MountModel& model, int connection, int axis,
                   const Eigen::Ref<const Eigen::VectorXd>& f, Eigen::MatrixXd& wrench);

/// Demanded wrench at an instant: of the mobile part's rotation, angular velocity, and accelerations (of Mo).
Vector6 calcDemand(const MobileBody& body, const Eigen::Vector3d& gravity, const Eigen::Matrix3d& R,
                   const Eigen::Vector3d& w, const Eigen::Vector3d& a, const Eigen::Vector3d& alpha);
/// The same at all samples.
Eigen::MatrixXd calcDemand(const OpenLoopRun& run, const MobileBody& body, const Eigen::Vector3d& gravity);

/// Demand less the load on the mobile part, plus all axes.
Eigen::MatrixXd calcMountResidual(const OpenLoopRun& run, const MountModel& model);

}  // namespace wems::identify
