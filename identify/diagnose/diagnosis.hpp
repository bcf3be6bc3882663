/// @file
/// What the simulation gets wrong: from recordings and a model to adjustments, named causes, what is left, and the
/// prediction of runs that were not used.
///
/// Order of the argument: (1) the equations of motion of mount and bracket along the measured motion, and the
/// consistency of each rigid part's channels, in units of their noise (identify/problem); (2) every number of the model
/// and of its sensors with its tolerance, and every cause of the catalogue, weighed by the evidence (identify/solve);
/// (3) free simulations before, with the adjustments, and after, against a band that noise and posterior allow.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identify/diagnose/selection.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// A fitted parameter under the name that results use. Value and interval are not finite for a stop that is removed.
struct CauseParameter {
    std::string name, unit;
    double value = 0;
    double lower = 0, upper = 0;  ///< 95 % interval
};

/// A cause that these data cannot tell from the one named.
struct Rival {
    std::string cause;
    std::vector<std::string> where;
    std::vector<CauseParameter> parameters;
    std::string separate_by;  ///< the run that would decide
};

struct Cause {
    std::string cause;
    double probability = 0;
    double gain_db = 0;  ///< validation error without it (others refitted) over that with all, dB
    double share = 0;    ///< of the squared validation error that adjustments and causes take away together
    std::vector<std::string> where;
    std::vector<CauseParameter> parameters;
    std::vector<Rival> rivals;
};

/// A number that moved within its tolerance.
struct Adjustment {
    CauseParameter parameter;
    double believed = 0, tolerance = 0;
};

struct GroupError {
    double identification = 0, validation = 0;
};

struct Diagnosis {
    enum class Verdict { explained, nothing_missing, unexplained };
    Verdict verdict = Verdict::nothing_missing;
    GroupError error_before, error_adjusted, error_after, noise_floor;
    double prediction_band = 0;           ///< validation error that noise and the posterior of all unknowns allow, 95 %
    std::vector<Cause> causes;            ///< by falling gain
    std::vector<Adjustment> adjustments;  ///< those that moved by more than their interval is wide
    std::vector<std::string> unexplained_where;  ///< connection.axis, `bracket`, then `free` or `contact`
    MountModel extended;
    bool validated = false;                           ///< false: the identification runs had to judge themselves
    std::vector<double> misfit_before, misfit_after;  ///< chi-squared per value: mount, bracket, sensors of both parts
    std::vector<Decision> decisions;                  ///< the selection's own record
    std::vector<std::string> notes;                   ///< how the motion was derived, what was found odd
};

struct DiagnosisOptions {
    std::function<void(const std::string&)> progress;  ///< may be empty
};

/// @param validation runs that judge; empty: the identification runs do, which `validated` says
/// @throws InputError if the motion cannot be recovered or a simulation is not possible
Diagnosis diagnose(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                   const MountModel& model, const DiagnosisOptions& options = {});

/// `explained`, `nothing_missing`, `unexplained`.
std::string formatVerdict(Diagnosis::Verdict verdict);

}  // namespace wems::identify
