/// @file
/// Random devices with a random hidden effect, and the runs that a diagnosis gets to see.
#pragma once

#include <array>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::hidden {

using Random = std::mt19937_64;

double drawUniform(Random& random, double lower, double upper);
double drawLog(Random& random, double lower, double upper);
int drawInteger(Random& random, int lower, int upper);
double drawSign(Random& random);

/// One cause of the catalogue, with places and parameters as results name them. A removed stop has a clearance that is
/// infinite.
struct Effect {
    std::string cause;
    std::vector<std::string> where;
    std::vector<std::pair<std::string, double>> parameters;
};

/// What no cause of the catalogue describes: a force at one axis of one connection.
struct OutsideEffect {
    enum class Kind { none, periodic_stiffness, disturbance, cross_axis, buckling };
    Kind kind = Kind::none;
    int connection = 0, axis = 0;
    int other_axis = 0;    ///< cross_axis: the axis whose displacement drives the force
    double size = 0;       ///< N/m (periodic_stiffness) or N
    double length = 1e-3;  ///< m, cross_axis and buckling
    double frequency = 0;  ///< Hz, periodic_stiffness and disturbance

    /// N along the axis, on the mobile part with the opposite sign; q the relative displacements of the connection.
    double calcForce(const Eigen::Vector3d& q, double time) const;
};
std::string formatKind(OutsideEffect::Kind kind);

struct RunPlan {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    double level = 0;  ///< N
    bool upward = true;
};

struct HiddenCase {
    std::string kind;  ///< `single`, `none`, `two`, `outside`
    MountModel base, truth;
    std::vector<Effect> effects;
    OutsideEffect outside;
    std::array<RunPlan, 3> runs;  ///< two to identify from, one to validate on
    double rate = 1000;           ///< Hz
    double octaves_per_minute = 14;
    double displacement_noise = 0, acceleration_noise = 0;  ///< m, m/s² RMS; zero: not recorded
    double gain_scatter = 0;                                ///< standard deviation of each channel's own gain
    double change[2] = {0, 0};      ///< relative change of the motion by the effect: identification, validation
    double amplification[3] = {0};  ///< of each run, see calcAmplification
};

/// A device without any effect; with stops, on a bracket.
MountModel drawDevice(Random& random);

/// Changes `truth` (and, for a stop that is missing, `base`).
/// @param cause one of the catalogue
Effect drawEffect(const std::string& cause, MountModel& base, MountModel& truth, Random& random);

/// The catalogue's causes.
const std::vector<std::string>& listCauses();

/// What is recorded: displacements, accelerations or both at random, or accelerations alone.
enum class Sensors { any, accelerations };

/// A complete case: effect sizes change the motion by 3 to 50 %, no run is chaotic. Sizes of outside effects are a
/// first guess.
/// @param kind as HiddenCase::kind, or the name of a cause
HiddenCase drawCase(const std::string& kind, Random& random, Sensors sensors = Sensors::any);

/// Records a run of the truth by the fast forward model, with noise and faults of sensors. No outside effect.
Recording recordForward(const HiddenCase& hidden, std::size_t run, std::uint64_t seed);

/// Adds noise and each channel's own gain to channels of the truth.
void addNoise(const HiddenCase& hidden, std::uint64_t seed, std::size_t run, Recording& recording);

/// Relative displacements of a free simulation, 3 · connections x samples.
Eigen::MatrixXd simulateRelative(const HiddenCase& hidden, const MountModel& model, std::size_t run);

}  // namespace wems::hidden
