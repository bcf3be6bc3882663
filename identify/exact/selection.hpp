/// @file
/// Which causes, together, explain the open-loop residual: forward selection with joint refits, exchange and removal.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identify/exact/catalogue.hpp"
#include "identify/exact/open_loop_problem.hpp"
#include "identify/exact/trial_fits.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify {

struct Selection {
    std::vector<Candidate> accepted;
    std::vector<std::vector<Trial>> rivals;  ///< for each accepted, those that fit as well in its place
    std::vector<double> without;             ///< validation misfit without it, the others refitted
    std::vector<MountModel> models_without;  ///< the models of these misfits
    ParameterFit fit;                        ///< all accepted together, on the identification runs
    /// Of each value of the fit: what the noise and the misfit make of it, widened where the validation runs alone want
    /// a value that differs by more.
    std::vector<double> standard_errors;
    double identification_before = 0, validation_before = 0;
    double identification_after = 0, validation_after = 0;
    std::vector<SearchRound> rounds;
};

struct SelectionOptions {
    int max_rounds = 6;
    int max_causes = 4;
    int trials = 8;                   ///< candidates fitted in each round
    double least_gain = 0.04;         ///< of the misfit per value, on both groups
    bool judged_elsewhere = false;    ///< the validation runs need not gain, only not lose: a simulation judges
    double least_fraction = 0.08;     ///< of what the validation misfit exceeds 1 by
    std::string only_place;           ///< axis (`1.x`) at which alone causes are tried; empty: everywhere
    std::vector<Candidate> excluded;  ///< not tried, nor the same cause at some of its places
    std::function<void(const std::string&)> progress;
};

/// @param validation the runs that judge; may be the identification runs themselves if there are no others
Selection selectCauses(OpenLoopProblem& identification, OpenLoopProblem& validation, const MountModel& model,
                       const SelectionOptions& options);

}  // namespace wems::identify
