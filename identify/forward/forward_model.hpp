/// @file
/// Free simulation of a mount, fast enough to be run thousands of times: the exact rigid body on its connections,
/// driven by a load on the modal bracket or on the mobile part, by a base acceleration, or by the recorded motion of
/// the fixed part.
///
/// Equations. With c the CoG (M axes), h the wheel's angular momentum (M axes), w the angular velocity in M axes, and
/// F, T the mount's force and moment about the CoG (models/mount_forces.hpp):
///
///     m p_cm'' = F + m (g − a_base),      I w' = R_GMᵀ T − w × (I w + h)
///     η_j'' + 2 ζ_j ω_j η_j' + ω_j² η_j = φ_jᵀ (−mount wrench, load) − φ_jᵀ M r a_base
///
/// Orientation is a unit quaternion, so that large rotations are exact. Under a base acceleration everything is
/// relative to the base, which moves without turning; accelerations of markers are absolute.
///
/// Held motions of the mobile part (`[body] motion`) obey models/guided_motion.hpp: accelerations with the guides'
/// reactions, and what the integration leaves in held directions is set to zero after each step.
///
/// Method: classical Runge–Kutta of fourth order, fixed steps (identify/forward/step_size.hpp tells how long), each cut
/// where a stop closes or opens or a bristle turns (identify/forward/stepper.hpp), so that it keeps its order there.
/// The result is a smooth function of the parameters while the sequence of contacts stays, which finite differences
/// need.
///
/// Everything is const and without shared scratch memory: any number of threads may simulate with the same object.
#pragma once

#include <Eigen/Core>
#include <stdexcept>

#include "identify/forward/drive.hpp"
#include "identify/forward/kernel_model.hpp"
#include "identify/forward/step_size.hpp"
#include "models/bracket.hpp"
#include "models/guided_motion.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

/// All that moves, at one instant.
struct ForwardState {
    BodyMotion mobile;         ///< M in G
    Eigen::VectorXd eta;       ///< bracket modes; empty if the fixed part's motion is prescribed
    Eigen::VectorXd eta_dot;   ///< likewise
    Eigen::VectorXd internal;  ///< states of MountForces
};

/// How much of a simulation is kept: relative displacements alone, or the states and their rates too, which
/// calcMarkers and calcEnergy need.
enum class Keep { displacement, states };

/// Result of a simulation. Column k belongs to sample first_sample + k of the drive's grid.
struct Simulation {
    int first_sample = 0;
    Eigen::MatrixXd q;              ///< relative displacement, F axes, m: row 3 i + axis of connection i
    Eigen::MatrixXd states, rates;  ///< in the forward model's own layout; Keep::states only
    ForwardState final_state;       ///< at the last column
    long evaluations = 0;           ///< of the equations of motion
};

/// Motion of the connections' ends in G: row 3 i + axis of connection i; displacement from rest.
struct MarkerMotion {
    Eigen::MatrixXd mobile_displacement, fixed_displacement;  ///< m
    Eigen::MatrixXd mobile_acceleration, fixed_acceleration;  ///< m/s²
};

class ForwardModel {
public:
    /// Cheap beside a simulation (microseconds; with gravity the static equilibrium is solved for).
    explicit ForwardModel(MountModel model);

    const MountModel& model() const { return model_; }

    /// What an ensemble simulates several models with (identify/forward/ensemble.hpp).
    const KernelModel& kernel() const { return kernel_; }
    bool holdsMotions() const { return guide_.active(); }
    Eigen::VectorXd packState(const ForwardState& state, const Drive& drive) const;
    /// Factors of each axis of the load at all table rows; empty = 1. @throws InputError as simulate() does
    Eigen::Matrix3Xd calcGains(const Drive& drive) const;

    /// Static equilibrium: mobile part at rest, states relaxed.
    const ForwardState& restState() const { return rest_; }
    /// Rest at the start of a drive: where the fixed part's motion is prescribed, the mobile part at rest relative to
    /// it, so that a table that is moving already takes it along.
    ForwardState restState(const Drive& drive) const;
    /// Relative displacements (3·connections) of the static equilibrium; zero without gravity.
    const Eigen::VectorXd& restDisplacement() const { return rest_displacement_; }

    /// Simulates all samples of the drive's grid from restState(drive).
    /// @throws SimulationDiverged, std::invalid_argument (samples outside the grid, state of another model), InputError
    /// (load correction over frequency, but the load is no sweep).
    Simulation simulate(const Drive& drive, Keep keep = Keep::displacement) const;

    /// Simulates `sample_count` samples from `initial` at `first_sample`: a window of multiple shooting.
    Simulation simulate(const Drive& drive, const ForwardState& initial, int first_sample, int sample_count,
                        Keep keep = Keep::displacement) const;

    /// State at column `column` of a simulation with Keep::states.
    ForwardState stateAt(const Simulation& simulation, const Drive& drive, int column) const;

    /// @throws std::invalid_argument without Keep::states.
    MarkerMotion calcMarkers(const Simulation& simulation, const Drive& drive) const;

    /// Kinetic, elastic and gravitational energy of body, connections and bracket (J) and the power that connections
    /// and bracket turn into heat (W), at a column of a simulation with Keep::states.
    double calcEnergy(const Simulation& simulation, const Drive& drive, int column) const;
    double calcDissipatedPower(const Simulation& simulation, const Drive& drive, int column) const;

private:
    class Guides;  // held motions, as the integration asks for them
    // Layout of the state: identify/forward/mount_kernel.hpp.
    Eigen::Index modeCount() const { return bracket_.modeCount(); }
    Eigen::Index stateSize(const Drive& drive) const;
    void pack(const ForwardState& state, const Drive& drive, double* y) const;
    ForwardState unpack(const double* y, const Drive& drive) const;
    BodyMotion calcBody(const double* y) const;
    FrameMotion calcFrame(const double* y, const Drive& drive, int half) const;
    Bracket::FrameAcceleration calcFrameAcceleration(const double* y, const double* rates, const Drive& drive,
                                                     int half) const;

    MountModel model_;
    MountForces forces_;
    Bracket bracket_;
    GuidedMotion guide_;
    KernelModel kernel_;
    ForwardState rest_;
    Eigen::VectorXd rest_displacement_;
};

}  // namespace wems::identify
