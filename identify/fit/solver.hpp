/// @file
/// Least squares for all parameters of a mount at once: linear ones exactly, clearances by Gauss–Newton from starts
/// found by a scan (variable projection). Works on inner products only, so an iteration costs no pass over the samples
/// except those in contact.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/fit/normal_equations.hpp"

namespace wems::identify {

/// The linearised problem at one point; parameters scaled by calcScale().
struct LinearSystem {
    std::vector<int> parameters;  ///< index of each row in the solver's list
    Eigen::VectorXd scale;
    Eigen::VectorXd gradient;     ///< of half the sum of squares
    Eigen::MatrixXd information;  ///< JᵀJ of the weighted equations
    Eigen::MatrixXd inverse;      ///< of the information; directions seen only in noise are left out
    Eigen::MatrixXd open;         ///< covariance that stands for those directions: several times the scale
    Eigen::VectorXd column_norm;  ///< of each scaled column
};

class Solver {
public:
    /// @param base model that the parameters start from and that weakly binds what the data say nothing about
    Solver(std::vector<RunMotion> const& motions, NormalEquations& equations, std::vector<Parameter> parameters,
           const MountModel& base);

    const MountModel& model() const { return model_; }
    const std::vector<Parameter>& parameters() const { return parameters_; }

    /// Everything: scan for stops, Gauss–Newton, weights from the residual, twice.
    void run();
    /// Takes a stop out of the regression (its parameters return to the base values) and solves again.
    void removeStop(const Parameter& of_stop);

    /// The linearised problem at the solution, for the parameters that take part.
    LinearSystem linearise() const { return makeSystem(true); }
    /// Derivative of the residual of run `run` to the parameters of `system` (scaled): rows 6 n + e.
    RowMatrix calcSensitivity(std::size_t run, const LinearSystem& system) const;
    /// The columns of the equations that make up that derivative: equations().apply() of it, of some outputs.
    Eigen::MatrixXd makeSensitivityColumns(const LinearSystem& system) const;
    Eigen::VectorXd calcResidual(std::size_t run) const;
    /// Sum of squares of the whitened residual, and the part of it that the channels' noise explains on average.
    double calcResidualSquares() const;
    double calcNoiseSquares() const;
    std::size_t runCount() const { return equations_.runs().size(); }
    const NormalEquations& equations() const { return equations_; }
    const std::vector<RunMotion>& motions() const { return motions_; }
    const MountModel& base() const { return base_; }

    /// How far each side of an axis was reached in any run, m, offset included (negative if never).
    double calcReach(const StopTerm& term) const;
    /// Largest clearance at which a stop of the model's stiffness would have been noticed; 0 if at none.
    double findNoticedClearance(const StopTerm& term);

    /// Gain in the sum of squares that a stop needs to be taken into the regression.
    static constexpr double kNoticed = 40;
    /// The base model binds with twice its own value as standard deviation.
    static constexpr double kPriorWeight = 0.25;

private:
    LinearSystem makeSystem(bool free_clearances) const;
    double calcObjective() const;
    Eigen::MatrixXd makeNoiseProducts() const;
    void setParameters(const LinearSystem& system, const Eigen::VectorXd& values);
    Eigen::VectorXd getParameters(const LinearSystem& system) const;
    void solveLinear();
    void solveAll();
    void scanStops();
    bool scanStop(const StopTerm& term);
    void updateWeights(bool from_residual);

    const std::vector<RunMotion>& motions_;
    NormalEquations& equations_;
    std::vector<Parameter> parameters_;
    MountModel base_, model_;
    std::vector<Eigen::MatrixXd> noise_;  // for each run, linear columns
    std::vector<StopTerm> all_stops_;
    std::vector<Matrix6d> first_whitening_;  // of each run: forces and moments to unit RMS
};

}  // namespace wems::identify
