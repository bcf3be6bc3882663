/// @file
/// Which set of hypotheses the recordings speak for, and what the unknowns are then.
///
/// The unknowns are ε = T ζ + Σ_h W_h z_h, ζ and z standard normal: tolerances, of which one may move several numbers,
/// and what each hypothesis of a set adds. With V = [T W], H = VᵀA V + 1 and g = −Vᵀ b of an information about the
/// believed state
///
///     log p(data | set) = ½ gᵀ H⁻¹ g − ½ log |H| + const,      ε̂ = V H⁻¹ g,      cov ε = V H⁻¹ Vᵀ
///
/// (Laplace; MacKay 1992, doi:10.1162/neco.1992.4.3.415; Beck and Yuen 2004,
/// doi:10.1061/(ASCE)0733-9399(2004)130:2(192)). All products VᵀA V are formed once; a set is then one small Cholesky
/// factor, and all that could join it are the Schur complements of one more solve.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "identify/problem/information.hpp"

namespace wems::identify {

// What a hypothesis sets free, on top of the tolerances that every number has anyway.

/// A direction in the space of columns: the unknown z ~ N(0, 1) moves each column's number by weight · z.
using Direction = std::vector<std::pair<int, double>>;

/// One physical statement: these numbers are off by far more than their tolerance, or this mechanism is there.
struct Hypothesis {
    std::string cause;               ///< `elastomer_stiffness`, as results name it
    std::vector<std::string> where;  ///< `4.z`, `body`, `mobile.1.az`
    std::vector<Direction> directions;
    std::vector<int> reported;  ///< rows of the parameter table that results list
    /// Rows of a direction that know each one's part of it to a relative standard deviation, about what it has in
    /// common.
    std::vector<std::pair<int, double>> shares;

    /// Where the law is not linear in a number, the directions above are of columns far from the state. Once taken, the
    /// state moves there, these rows count from their new values, and `tangent` replaces the directions.
    std::vector<std::pair<int, double>> start;
    std::vector<Direction> tangent;
    std::vector<std::pair<int, int>> moves;  ///< a probe's column and the row that its amplitude is added to

    double log_prior = 0;  ///< log of the prior odds of the statement against its absence
};

/// Tolerances of columns that have nothing to do with each other. @param deviation prior standard deviations, 0 = known
std::vector<Direction> makeTolerances(const Eigen::VectorXd& deviation);

/// Indices into the list of hypotheses, ascending.
using HypothesisSet = std::vector<int>;

/// Unknowns and their uncertainty under a set.
struct Posterior {
    Eigen::VectorXd mean;        ///< of each column, from the believed state
    Eigen::MatrixXd covariance;  ///< of each column
    double log_evidence = 0;
};

/// The estimate of a set and what it costs.
struct SetSolution {
    Eigen::VectorXd mean;     ///< of each column, from the believed state
    double prior_square = 0;  ///< ζ² + z² of it
    double occam = 0;         ///< −½ log |H| + log odds of the members
};

struct RankedSet {
    HypothesisSet members;
    double log_evidence = 0;  ///< of the data, and of the set: log odds of the members included
};

class Evidence {
public:
    /// @param information about the believed state, one entry for each column
    /// @param tolerances directions in which the prior knows a standard deviation, whatever the set
    Evidence(const BlockInformation& information, const std::vector<Direction>& tolerances,
             const std::vector<Hypothesis>& hypotheses);

    double calcLogEvidence(const HypothesisSet& set) const;
    Posterior calcPosterior(const HypothesisSet& set) const;
    SetSolution solve(const HypothesisSet& set) const;
    /// Mean of each column that a step of Levenberg (1944) leads to: the quadratic, the prior, and `damping` times the
    /// prior about the present point, so that what the prior knows to a little moves a little.
    /// @param slope C⁻¹ of the present point, C the set's prior covariance
    Eigen::VectorXd solveNear(const HypothesisSet& set, const Eigen::VectorXd& slope, double damping) const;

    /// Twice what the quadratic of the information says of a point, beside its χ²: 2 bᵀε + εᵀA ε.
    double calcChange(const Eigen::VectorXd& estimate) const;

    /// log evidence (data and odds) of `set` with each other hypothesis added; −∞ where it cannot join: it is a member,
    /// or makes the same statement of a place that a member does.
    std::vector<double> calcExtensions(const HypothesisSet& set) const;

    /// Beam search from `start` and from nothing: additions, removals and exchanges, until no set of the beam changes.
    /// @return sets by falling evidence
    std::vector<RankedSet> search(const std::vector<HypothesisSet>& starts, std::size_t width,
                                  std::size_t largest) const;

private:
    std::vector<Eigen::Index> findRows(const HypothesisSet& set) const;
    double calcOdds(const HypothesisSet& set) const;
    bool mayJoin(const HypothesisSet& set, int hypothesis) const;

    BlockInformation information_;
    const std::vector<Hypothesis>* hypotheses_;
    Eigen::Index tolerances_;          // directions that every set has
    std::vector<Eigen::Index> first_;  // of each hypothesis' directions, after those
    Eigen::MatrixXd directions_;       // V: columns x directions
    Eigen::MatrixXd gram_;             // VᵀAV
    Eigen::VectorXd right_;            // −Vᵀ b
};

/// C⁻¹ ε, C = Σ d dᵀ the prior covariance that directions make: the slope of −log prior at an estimate. Zero where no
/// direction leads; what lies across all directions of some columns counts for nothing.
Eigen::VectorXd calcPriorSlope(const std::vector<Direction>& directions, const Eigen::VectorXd& estimate);

/// S with S Sᵀ the covariance, which may be singular: of its correlations, so that units of very different size do not
/// lend each other their rounding. What is known has a row of zeros.
Eigen::MatrixXd calcCovarianceRoot(const Eigen::MatrixXd& covariance);

/// An information about `state` carried to the believed values: columns' believed minus present values in `offset`.
BlockInformation shiftToBelieved(const BlockInformation& about_state, const Eigen::VectorXd& offset);
Information shiftToBelieved(const Information& about_state, const Eigen::VectorXd& offset);

/// Misfit of one block at an estimate (from the believed state), per value.
double calcBlockMisfit(const BlockInformation& block, const Eigen::VectorXd& estimate);

}  // namespace wems::identify
