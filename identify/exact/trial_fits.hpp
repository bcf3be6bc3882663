/// @file
/// The candidates that promise most, each fitted together with what was accepted before.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "identify/exact/catalogue.hpp"
#include "identify/exact/open_loop_problem.hpp"
#include "identify/exact/screening.hpp"

namespace wems::identify {

// Gauss–Newton (Levenberg–Marquardt) fit of knobs to the whitened open-loop residual.

struct ParameterFit {
    MountModel model;            ///< with the fitted values
    std::vector<double> values;  ///< of the knobs
    Eigen::MatrixXd covariance;  ///< of the values, from unit noise, calibration scatter included
    double misfit = 0;           ///< for each value: about 1 for a perfect model
    WhiteVector residual;
    int iterations = 0;
};

/// Fits from the values that `start` has. Values stay in their physical range.
ParameterFit fitParameters(const OpenLoopProblem& problem, const MountModel& start, const std::vector<Knob>& knobs,
                           int max_iterations = 12);

/// A candidate fitted jointly with all that had been accepted. Misfits are per value: 1 for a perfect model.
struct Trial {
    Candidate candidate;
    std::vector<double> values;  ///< of its knobs
    double identification = 0;
    double validation = 0;
};

struct FittedTrial {
    Trial trial;
    ParameterFit fit;  ///< of the identification runs, the accepted ones included
};

struct TrialOptions {
    double least_gain = 0;   ///< of the misfit per value; what promises less than a quarter of it is not fitted
    std::string only_place;  ///< axis (`1.x`) at which alone causes are tried; empty: everywhere
    std::vector<Candidate> excluded;  ///< not tried, nor the same cause at some of its places
};

class TrialFits {
public:
    /// @param identification, validation must outlive this
    TrialFits(const OpenLoopProblem& identification, const OpenLoopProblem& validation, TrialOptions options);

    /// Around which model the first look takes the forces from now on; to be called before the first fitBest().
    void lookAround(const MountModel& model);

    /// Screens the catalogue of the present model, without laws at places that its residual excludes, and fits the
    /// `count` most promising candidates jointly with `accepted`; best first, parameters priced. Uses two threads.
    std::vector<FittedTrial> fitBest(const ParameterFit& present, const std::vector<Candidate>& accepted, int count);

    /// What a parameter costs, as half of a sum of squares, where a misfit is left: ½ ln(size), of the noise that is.
    double price(double misfit) const;

private:
    bool isExcluded(const Candidate& candidate) const;
    std::vector<Candidate> makePossible(const ParameterFit& present) const;
    double score(const Trial& trial) const;

    const OpenLoopProblem &identification_, &validation_;
    TrialOptions options_;
    bool with_bracket_ = false;
    std::unique_ptr<LawDifferences> laws_;
};

/// All knobs of some candidates in a row.
std::vector<Knob> collectKnobs(const std::vector<Candidate>& candidates);

}  // namespace wems::identify
