/// @file
/// What a diagnosis answers: verdict, causes, adjustments, errors, and how it came to them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/common/progress.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Half width of the 95 % interval of a normal variable, in standard deviations.
inline constexpr double kTwoSided95 = 1.959963984540054;

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

struct GroupError {
    double identification = 0, validation = 0;
};

/// A number that moved within its tolerance.
struct Adjustment {
    CauseParameter parameter;
    double believed = 0, tolerance = 0;
};

/// One candidate of a round with its figures.
struct RankedCause {
    std::string cause;
    std::vector<std::string> where;
    double log_odds = 0;  ///< of the set with it over the set that the round began with
};

/// A set of causes that a round fitted, and what became of it.
struct FittedSet {
    std::vector<std::string> causes;  ///< `clearance 4.z.+`
    double log_evidence = 0;          ///< at its own end, over the set that the round began with at its own
    std::optional<double> error;      ///< of the prediction, where it was simulated
    std::string outcome;              ///< `taken`, or why not
};

/// What a round tried and did.
struct Decision {
    std::string action;                   ///< one sentence
    std::vector<std::string> causes;      ///< those taken after the round, `clearance 4.z.+`
    double log_evidence = 0;              ///< of that set over no cause, at the round's linearisation
    std::vector<double> misfit;           ///< chi-squared per value: mount, bracket, mobile and fixed sensors
    double error = 0;                     ///< of the prediction after the round
    std::vector<RankedCause> candidates;  ///< the best few
    std::vector<FittedSet> fitted;        ///< in the order in which they were tried
};

/// Misfit of the mount's equation along the runs that judge, per value, in bands of an eighth of an octave; 1 for a
/// perfect model.
struct MisfitSpectrum {
    std::vector<double> frequency, before, after;  ///< Hz, -, -
};

/// The elastic force of an axis as the recordings have it, where no law of the catalogue is it: over the range of the
/// displacement, what a static test of that axis would show.
struct ElasticLaw {
    std::string where;  ///< connection.axis
    /// Displacement (m), force (N) of the believed law and of the recordings, standard deviation (N) of the latter.
    std::vector<double> displacement, believed, force, deviation;
};

struct Diagnosis {
    enum class Verdict { explained, nothing_missing, unexplained };
    Verdict verdict = Verdict::nothing_missing;
    GroupError error_before, error_after, noise_floor;
    GroupError error_adjusted;                   ///< with the adjustments alone
    std::optional<double> prediction_band;       ///< validation error that noise and the posterior allow, 95 %
    std::optional<double> identification_band;   ///< the same of the identification runs, where it was asked for
    std::vector<Cause> causes;                   ///< by falling gain
    std::vector<Adjustment> adjustments;         ///< of which the recordings say something
    std::vector<std::string> unexplained_where;  ///< connection.axis, `bracket`, then `free` or `contact`
    std::vector<ElasticLaw> elastic_laws;        ///< of another form than any cause gives them
    MountModel extended;
    bool of_element = false;   ///< errors are of an element's force, not of a free simulation's displacements
    bool validated = false;    ///< false: the identification runs had to judge themselves
    double misfit_before = 0;  ///< open-loop misfit of the validation runs per value; 1 for a perfect model
    double misfit_after = 0;
    MisfitSpectrum spectrum;
    std::vector<Decision> decisions;
    std::vector<std::string> notes;  ///< how the motion was derived, what was found odd
};

struct DiagnosisOptions {
    ProgressListener progress;  ///< may be empty
};

/// `explained`, `nothing_missing`, `unexplained`.
std::string formatVerdict(Diagnosis::Verdict verdict);

}  // namespace wems::identify
