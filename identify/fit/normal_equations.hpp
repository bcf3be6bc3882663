/// @file
/// Inner products of all columns of the equations of motion over several runs, each run whitened by its own 6 × 6
/// covariance. The linear columns are multiplied once; a stop's columns again whenever its clearance moves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/fit/equation_of_motion.hpp"
#include "identify/fit/parameter_set.hpp"

namespace wems::identify {

/// A stop that takes part in the regression.
struct StopTerm {
    int connection = 0, axis = 0, stop = 0;
    int historyIndex() const { return 3 * connection + axis; }
    bool operator==(const StopTerm& other) const {
        return connection == other.connection && axis == other.axis && stop == other.stop;
    }
};

class NormalEquations {
public:
    explicit NormalEquations(std::vector<RunEquations> runs);

    const std::vector<RunEquations>& runs() const { return runs_; }
    const ColumnLayout& layout() const { return runs_.front().layout; }
    int outputCount() const;

    /// Rescales each run on top of what was done before: its rows become transform · rows. setStops() must follow.
    void whiten(const std::vector<Matrix6d>& transforms);
    const Matrix6d& whitening(std::size_t run) const { return whitenings_[run]; }

    /// Replaces the stops in the regression by these, at the model's clearances.
    void setStops(const MountModel& model, std::vector<StopTerm> stops);
    /// Recomputes the columns of those stops whose clearance in `model` has changed.
    void updateStops(const MountModel& model);
    const std::vector<StopTerm>& stops() const { return stops_; }

    /// Columns of the Gram matrix: layout().count() linear ones, then a value column for each stop, then a slope
    /// column for each stop.
    const Eigen::MatrixXd& gram() const { return gram_; }
    int valueColumn(std::size_t stop) const { return layout().count() + static_cast<int>(stop); }
    int slopeColumn(std::size_t stop) const { return valueColumn(stop) + static_cast<int>(stops_.size()); }

    /// Coefficients of the columns for a model; zero for the slope columns.
    Eigen::VectorXd makeCoefficients(const MountModel& model) const;
    /// Derivative of the coefficients to the parameters, those of stops by their slope columns.
    Eigen::MatrixXd makeJacobian(const MountModel& model, const std::vector<Parameter>& parameters) const;

    /// All columns · `combination` for one run (gram() columns × any number of vectors): 6 outputs × that number.
    RowMatrix apply(std::size_t run, const Eigen::MatrixXd& combination) const;
    /// Of `count` outputs from `first` on.
    RowMatrix apply(std::size_t run, const Eigen::MatrixXd& combination, int first, int count) const;
    const StopColumn& stopColumn(std::size_t run, std::size_t stop) const { return columns_[run][stop]; }

private:
    void updateLinear();
    void updateProducts(std::size_t stop);

    std::vector<RunEquations> runs_;
    std::vector<Matrix6d> whitenings_;
    std::vector<StopTerm> stops_;
    std::vector<double> clearances_;
    std::vector<std::vector<StopColumn>> columns_;  // for each run, each stop; whitened
    Eigen::MatrixXd gram_;
};

/// The law's stop that a term stands for.
const Stop& stopOf(const MountModel& model, const StopTerm& term);

// What the noise of the recorded channels adds to the inner products of the equations' columns. Regressors are
// measured, too: without subtracting this, a motion that was never excited would seem to identify a stiffness from
// noise alone, and every estimate would be drawn towards zero (errors in variables).
//
// Pose noise n (translation, rotation; white over samples, of the part's six degrees of freedom as the rigid fit
// leaves it) reaches column j as L_j n filtered by T_j(f): the test function times 1, iω or −ω² for columns of
// displacement, velocity and acceleration. With Σ the covariance of n and W the weight of the equations, per output
//
//     E[x_jᵀ W x_l] = tr(L_jᵀ W L_l Σ) · (2/f_s) ∫ Re(T_j T_l*) df.
//
// Source: Fuller, Measurement Error Models (1987), ch. 2.

/// Expected inner products (layout.count() squared) of the noise in all linear columns, one run, summed over outputs.
/// @param whitening of the run's rows
Eigen::MatrixXd calcNoiseProducts(const RunMotion& motion, const MountModel& model, const RunEquations& equations,
                                  const Matrix6d& whitening);

}  // namespace wems::identify
