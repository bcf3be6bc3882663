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
/// Method: classical Runge–Kutta of fourth order, fixed steps (identify/forward/step_size.hpp tells how long). Fixed
/// steps make the result a smooth function of the parameters between contacts, which finite differences need. A stop
/// that closes within a step is met to third order in that step.
///
/// Everything is const and without shared scratch memory: any number of threads may simulate with the same object.
#pragma once

#include <Eigen/Core>
#include <stdexcept>

#include "identify/forward/drive.hpp"
#include "models/bracket.hpp"
#include "models/guided_motion.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

/// The motion grew beyond all bounds; the message tells when.
class SimulationDiverged : public std::runtime_error {
public:
    explicit SimulationDiverged(double time);
};

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
    struct Forcing;  // what acts from outside, at all table rows
    // Layout of the state: CoG position (G), quaternion (w x y z) of R_GM, CoG velocity (G), angular velocity (M),
    // then modal coordinates, their rates, internal states of the connections.
    static constexpr int at_position = 0, at_quaternion = 3, at_velocity = 7, at_angular = 10, at_modes = 13;
    Eigen::Index modeCount() const { return bracket_.modeCount(); }
    Eigen::VectorXd calcGains(const Drive& drive) const;  // of the load at all table rows; empty = 1
    Eigen::Index stateSize(const Drive& drive) const;
    void pack(const ForwardState& state, const Drive& drive, double* y) const;
    ForwardState unpack(const double* y, const Drive& drive) const;
    BodyMotion calcBody(const double* y) const;
    FrameMotion calcFrame(const double* y, const Drive& drive, int half) const;
    Bracket::FrameAcceleration calcFrameAcceleration(const double* y, const double* rates, const Drive& drive,
                                                     int half) const;
    void guide(const double* y, const BodyMotion& body, const Bracket::Kinematics& fixed, const Forcing& forcing,
               int half, const Wrench& applied, double* rates) const;
    void project(double* y, const Drive& drive, int half) const;
    void calcRates(const double* y, const Forcing& forcing, int half, double* rates) const;
    void calcDisplacement(const double* y, const Drive& drive, int half, double* q) const;

    MountModel model_;
    MountForces forces_;
    Bracket bracket_;
    GuidedMotion guide_;
    Eigen::Matrix3d inverse_inertia_;
    ForwardState rest_;
    Eigen::VectorXd rest_displacement_;
};

}  // namespace wems::identify
