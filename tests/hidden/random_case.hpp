/// @file
/// Random devices with a random hidden effect, and the runs that a diagnosis gets to see.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"
#include "tests/hidden/device_motion.hpp"
#include "tests/hidden/outside_effect.hpp"
#include "tests/hidden/random_numbers.hpp"
#include "tests/hidden/run_plan.hpp"
#include "tests/hidden/sensor_errors.hpp"
#include "tests/hidden/set_up.hpp"
#include "tests/hidden/small_errors.hpp"

namespace wems::hidden {

/// One cause of the catalogue, with places and parameters as results name them. A removed stop has a clearance that is
/// infinite.
struct Effect {
    std::string cause;
    std::string variant;  ///< `one`, `both_sides`, `all_of_direction`, `missing`, `too_many`, `drop_out` …
    std::vector<std::string> where;
    std::vector<std::string> names;  ///< of parameters, as getParameter knows them
};

struct HiddenCase {
    std::string kind;  ///< `single`, `none`, `two`, `outside`
    SetUp set_up;
    MountModel base;          ///< the device without its effects, every number exact
    MountModel truth;         ///< with them; `sensors` are hidden faults
    MountModel believed;      ///< `base` with small errors
    double small_errors = 0;  ///< SmallErrors::share of the level
    std::vector<Effect> effects;
    OutsideEffect outside;
    std::array<RunPlan, 3> runs;                            ///< two to identify from, one to validate on
    double rate = 1000;                                     ///< Hz
    double displacement_noise = 0, acceleration_noise = 0;  ///< m, m/s² RMS; zero: not recorded
    SensorErrors sensors;
    /// All above is for unit time; the device that is handed out is slower by this factor (time_scale.hpp).
    double time_scale = 1;
    double change[2] = {0, 0};      ///< relative change of the motion by the effect: identification, validation
    double amplification[3] = {0};  ///< of each run: relative change of the motion over that of the mass
};

/// A device without any effect; with stops, on a bracket.
MountModel drawDevice(Random& random);
/// One body on one or two connections that act along z alone; no bracket.
MountModel drawAxisDevice(Random& random);

/// Changes `truth` (and, for a stop that is missing, `base`).
/// @param cause one of the catalogue
/// @param level of small errors: from 1 on what has a tolerance is off by 2.5 tolerances of the level to 8 of level 2
Effect drawEffect(const std::string& cause, MountModel& base, MountModel& truth, Random& random, int level = 0,
                  const SetUp& set_up = {});

/// The catalogue's causes.
const std::vector<std::string>& listCauses();
/// Those that can be hidden in a set-up.
std::vector<std::string> listCauses(const SetUp& set_up);

/// What is recorded: displacements, accelerations or both at random, or one of them.
enum class Sensors { any, accelerations, displacements, both };

struct CaseOptions {
    std::string kind = "single";  ///< as HiddenCase::kind, or the name of a cause
    int level = 0;                ///< of small errors
    Sensors sensors = Sensors::any;
    std::optional<SetUp> set_up;           ///< absent: drawn
    std::string set_up_kind = "any";       ///< `bracket`, `base`, `axis`: only of these drawn
    std::optional<Excitation> excitation;  ///< absent: drawn
    std::optional<double> time_scale;      ///< absent: drawn
};

/// A complete case: effects change the motion by 5 to 50 %, no run is chaotic. Sizes of outside effects are scaled to
/// that, too.
HiddenCase drawCase(const CaseOptions& options, Random& random);

/// Load on the bracket, logarithmic sweeps, no small errors, unit time.
/// @param kind as HiddenCase::kind, or the name of a cause
HiddenCase drawCase(const std::string& kind, Random& random, Sensors sensors = Sensors::any);

/// Records a run of the truth, with noise and faults of sensors, in the time of the device that is handed out.
Recording recordForward(const HiddenCase& hidden, std::size_t run, std::uint64_t seed);

/// Relative displacements of a free simulation, 3 · connections x samples at 1 kHz, in unit time, with steps for speed.
Eigen::MatrixXd simulateRelative(const HiddenCase& hidden, const MountModel& model, std::size_t run);

}  // namespace wems::hidden
