/// @file
/// Model updating with causes: every number of the model and of its sensors may lie anywhere within its tolerance, and
/// what lies beyond it, or is a mechanism that the model lacks, is a cause.
///
/// Order of the argument: (1) the equations of motion of mount and bracket along the measured motion, and the
/// consistency of each rigid part's channels, in units of their noise (identify/problem); (2) every number with its
/// tolerance, and every cause of the catalogue, weighed by the evidence (identify/solve); (3) free simulations before,
/// with the adjustments, and after, against a band that noise and posterior allow.
#pragma once

#include <memory>

#include "identify/updating/test_problem.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

/// Under one assumption of the numbers. Whether its answer is asked for can be known before the simulations that it
/// takes to report it.
class ModelUpdate {
public:
    /// @param problem as constructed
    ModelUpdate(const TestProblem& problem, const MountModel& model, Numbers numbers, const DiagnosisOptions& options);
    ~ModelUpdate();
    ModelUpdate(const ModelUpdate&) = delete;
    ModelUpdate& operator=(const ModelUpdate&) = delete;

    /// (1) and (2).
    /// @throws InputError if a simulation is not possible
    void select();
    /// Of what was selected: whether the recordings speak for more than exact numbers may have.
    bool asksForMore() const;
    /// (3), once, after `select`.
    /// @throws InputError if a simulation is not possible
    Diagnosis report();

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace wems::identify::updating
