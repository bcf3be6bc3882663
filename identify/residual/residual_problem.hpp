/// @file
/// Unknowns with tolerances and hypotheses against a residual of unknown size, such as the force of an element along
/// its tests.
///
/// With RSS the sum of squares of the residual and N_e the number of its independent values, the unknowns z (standard
/// normal, as in identify/solve/evidence.hpp) maximise
///
///     −½ N_e ln RSS(z) − ½ zᵀz
///
/// and the evidence of a set is this maximum less ½ ln |1 + N_e / RSS · JᵀJ|, J the residual's slopes by z (Laplace),
/// plus the log odds of its members: the criterion of the diagnosis of whole mounts (identify/solve), where the noise
/// is known instead. Laws are fitted as they are, by steps of Levenberg and Marquardt, not to first order.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "identify/problem/unknown.hpp"
#include "identify/solve/evidence.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify {

/// A set of hypotheses with its most probable numbers.
struct ResidualFit {
    HypothesisSet set;
    Eigen::VectorXd values;                    ///< of each row of the table
    std::vector<std::pair<int, double>> held;  ///< rows that were kept at a value
    Eigen::VectorXd residual;
    Eigen::MatrixXd slopes;      ///< of the residual by each unknown z, sign reversed
    Eigen::MatrixXd covariance;  ///< of each row
    double sum_of_squares = 0;   ///< RSS
    double samples = 0;          ///< N_e
    double log_evidence = 0;
};

class ResidualProblem {
public:
    ResidualProblem() = default;
    virtual ~ResidualProblem() = default;
    ResidualProblem(const ResidualProblem&) = delete;
    ResidualProblem& operator=(const ResidualProblem&) = delete;

    const UnknownTable& table() const { return table_; }
    const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
    Eigen::VectorXd believedValues() const;

    /// Relative errors of the tests that are fitted to and of those that judge.
    virtual GroupError calcErrors(const Eigen::VectorXd& values) const = 0;
    /// What noise alone would leave.
    virtual GroupError calcNoiseFloor() const = 0;
    /// Square of the relative difference that two points make to the tests that judge.
    virtual double calcJudgedDifference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const = 0;

    /// The most probable numbers of a set.
    /// @param samples N_e
    /// @param start values from where they are sought; rows that a member has a start for begin there
    /// @param held rows that keep a value
    ResidualFit fit(const HypothesisSet& set, double samples, const Eigen::VectorXd& start,
                    const std::vector<std::pair<int, double>>& held = {}) const;

    /// The evidence that a fit would gain by one more hypothesis, to first order: for the choice of those to fit.
    double predictGain(const ResidualFit& fit, int hypothesis) const;

    /// Independent values of a residual.
    static double countSamples(const Eigen::VectorXd& residual);

protected:
    /// What the tests that are fitted to leave at a point.
    virtual Eigen::VectorXd calcResidual(const Eigen::VectorXd& values) const = 0;
    /// Sum of squares of what is measured: a residual is never taken for less than its rounding.
    virtual double calcSignalSquare() const = 0;

    UnknownTable table_;
    std::vector<Hypothesis> hypotheses_;
};

}  // namespace wems::identify
