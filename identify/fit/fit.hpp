/// @file
/// Stiffness, clearance, stop stiffness and damping of each connection and axis from measured runs, with intervals, and
/// what these runs cannot tell.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/fit/identifiability.hpp"
#include "identify/fit/intervals.hpp"
#include "identify/fit/remainder.hpp"
#include "identify/fit/solver.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

// Wall-clock time of the steps of a computation.

class Stopwatch {
public:
    /// Steps are appended to `laps`, in seconds.
    explicit Stopwatch(std::vector<std::pair<std::string, double>>& laps) : laps_(laps) {}
    void lap(const std::string& name) {
        const auto now = std::chrono::steady_clock::now();
        laps_.emplace_back(name, std::chrono::duration<double>(now - last_).count());
        last_ = now;
    }
    /// The next step begins now.
    void restart() { last_ = std::chrono::steady_clock::now(); }

private:
    std::vector<std::pair<std::string, double>>& laps_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct SolvedParameters;  // open_groups.hpp

struct FitOptions {
    std::vector<std::string> free_body;  ///< `body.center_of_gravity`, `body.inertia`, or components of them
    double knot_time = 0;                ///< s, width h of the test function; 0: chosen from the channels and the rate
    /// Relative error of a regressor that sensors' gains and positions may have: what is told apart only by less is
    /// not told apart.
    double geometry_error = 2e-3;
};

struct FittedParameter {
    std::string name, unit;
    double model_value = 0;
    double value = 0;
    double standard_error = 0;
    std::array<double, 2> interval95{};
};

/// Parameters that are not known one by one. Each of their known combinations is an entry of its own; without one
/// `combination` is empty.
struct UnidentifiedGroup {
    std::vector<std::string> names;
    std::string combination;  ///< `1.x.stiffness + 2.x.stiffness`
    double value = 0;         ///< of the combination
    std::array<double, 2> interval95{};
    std::string unit;
    std::string reason;  ///< `not reached: clearance > 0.00152 m`; may be empty
    std::string separate_by;
};

/// All numbers that took part, known one by one or not.
struct JointEstimate {
    std::vector<std::string> names;
    Eigen::VectorXd values;      ///< SI
    Eigen::MatrixXd covariance;  ///< SI; of directions that the runs leave open several times their sizes
};

/// Relative displacements of a run, without what the sensors read of nothing; a row for each name, m.
struct FittedTrajectory {
    std::string file;
    std::vector<double> time;        ///< s
    std::vector<std::string> names;  ///< `4.z`
    Eigen::MatrixXd measured, simulated;
};

struct FitResult {
    MountModel model;  ///< with the identified values; open combinations shared in proportion to the model's values
    std::vector<FittedParameter> parameters;
    std::vector<UnidentifiedGroup> not_identifiable;
    JointEstimate estimate;
    /// Clearance of each stop that was not reached, and up to where it would have been noticed, m.
    std::map<std::string, double> unreached;
    bool by_simulation = false;      ///< output_error.hpp
    double residual_fraction = 0;    ///< RMS of the unexplained wrench over that of the demanded one; by simulation, of
                                     ///< the error of the relative displacements over that of the measured ones
    double residual_over_noise = 0;  ///< of the weighted equations, RMS over what the channels' noise gives; 0 if
                                     ///< unknown; by simulation infinite if unknown
    std::vector<ParameterDirection> directions;  ///< how well the equations determine the parameters
    std::vector<RunRemainder> remainders;        ///< of each run; none by simulation
    std::vector<FittedTrajectory> trajectories;  ///< of each run; by simulation alone
    std::vector<std::string> notes;
    std::vector<std::pair<std::string, double>> timing;  ///< step, s
};

/// Runs of accelerations alone first get the slow part of their motion from the balance of the mount's force
/// (slow_offset.hpp), which takes some ten fits.
/// @throws InputError if there is no run, a run is shorter than the test function, or a name in `free_body` is wrong.
FitResult fitMount(const std::vector<RunMotion>& measured, const MountModel& model, const FitOptions& options = {});

// From the solution of the regression to what a user is told: known values, open groups, the fitted model.

/// Fills parameters, not_identifiable, residual_fraction, model and notes of `result`.
void fillResult(Solver& solver, const LinearSystem& system, const ParameterUncertainty& uncertainty,
                const FitOptions& options, FitResult& result);

/// What is left should be noise: the note where it is not.
std::optional<std::string> describeMissingTerms(const FitResult& result);

/// The part of it that needs values and half widths alone: known parameters, open groups, the fitted model.
void fillParameters(const SolvedParameters& solved, const Identifiability& identifiability,
                    const std::function<double(const Eigen::VectorXd&)>& calcStandardError, FitResult& result);

}  // namespace wems::identify
