/// @file
/// The whitened open-loop residual of a group of runs as a function of the model, with calibration scatter
/// marginalised.
///
/// Every channel may have an ordinary calibration error, and so may the load: a gain 1 + g, g of known small standard
/// deviation. To first order it adds N g to the residual; integrating over g replaces the inner product of two
/// residuals or columns by
///
///     <a, b> = aᵀ b − aᵀ N (NᵀN + λ)⁻¹ Nᵀ b      (N scaled by the standard deviations)
///
/// so that nothing is named that such scatter could make. λ is the variance of what a model leaves, in units of the
/// noise: 1 for a perfect model. The equations are homogeneous, but for the stops, so that gains of zero would solve
/// them: judged by noise alone, a residual hundreds of times larger would be cheapest to explain by that. λ, never
/// below 1, is the largest solution of <y, y> / size = λ.
///
/// Faults that all displacement channels of a side share (`mobile`, `fixed` in the model's sensors) act to first order.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "identify/exact/whitening.hpp"
#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/open_loop_run.hpp"

namespace wems::identify {

/// A vector with its products with the calibration columns.
struct WhiteVector {
    Eigen::VectorXf values;
    Eigen::VectorXd calibration;  ///< Nᵀ values
    bool isZero() const { return values.size() == 0; }
};

class OpenLoopProblem {
public:
    /// @param gain_scatter standard deviation of an ordinary channel's gain
    OpenLoopProblem(std::vector<OpenLoopRun> runs, const MountModel& model, double gain_scatter);

    const std::vector<OpenLoopRun>& runs() const { return runs_; }
    const Whitening& whitening(std::size_t run) const { return *whitenings_[run]; }
    /// True if the slow motion of a run was not measured, so that it follows the model.
    bool hasSlowBalance() const;
    bool hasBracket(std::size_t run) const { return brackets_[run] != nullptr; }
    /// Only where hasBracket().
    const BracketEquation& bracket(std::size_t run) const { return *brackets_[run]; }
    Eigen::Index size() const { return size_; }
    /// First value of a run.
    Eigen::Index offset(std::size_t run) const { return offsets_[run]; }

    /// Takes the noise, the calibration columns and, where it was not measured, the slow motion that belong to another
    /// model, which becomes the reference.
    void rewhiten(const MountModel& model);
    /// The residual of the reference is kept; others are computed from what differs.
    void setReference(const MountModel& model);
    const MountModel& reference() const { return reference_; }

    WhiteVector calcResidual(const MountModel& model) const;
    /// Residual of `to` minus that of `from`; values empty if nothing that is measured here differs.
    WhiteVector calcDifference(const MountModel& from, const MountModel& to) const;
    /// True if body, bracket, load and sensors are the same.
    static bool differInLawsAlone(const MountModel& from, const MountModel& to);
    /// A vector of whitened values with its calibration products.
    WhiteVector makeVector(Eigen::VectorXf values) const;

    /// N, in standard deviations, turned so that its columns are orthogonal.
    const Eigen::MatrixXf& calibrationColumns() const { return calibration_; }
    /// λ of a residual.
    double calcVariance(const WhiteVector& residual) const;
    double product(const WhiteVector& a, const WhiteVector& b, double variance) const;
    /// <y, y> with its own λ, for each value: about 1 for a perfect model.
    double calcMisfit(const WhiteVector& residual) const;
    double calcMisfit(const MountModel& model) const { return calcMisfit(calcResidual(model)); }
    /// A residual without the calibration errors that it makes likely; together they stay within the scatter.
    Eigen::VectorXf removeCalibration(const WhiteVector& residual) const;

private:
    void makeCalibrationColumns();
    Eigen::VectorXf calcValues(const MountModel& model) const;
    /// Change of the bracket's residual of a run; empty if there is none.
    Eigen::MatrixXd calcBracketDifference(std::size_t run, const MountModel& from, const MountModel& to) const;
    /// True if what differs are bracket modes, whose inputs are known from the reference.
    bool differInModesAlone(const MountModel& from, const MountModel& to) const;
    void addModesDifference(std::size_t run, const MountModel& from, const MountModel& to,
                            Eigen::VectorXf& values) const;
    void addSideFaults(const MountModel& model, float sign, Eigen::VectorXf& values) const;

    std::vector<OpenLoopRun> runs_;
    std::vector<std::unique_ptr<Whitening>> whitenings_;
    std::vector<std::unique_ptr<BracketEquation>> brackets_;
    std::vector<Eigen::Index> offsets_;
    Eigen::Index size_ = 0;
    double gain_scatter_;
    MountModel reference_;
    WhiteVector reference_residual_;
    std::vector<Eigen::MatrixXcd> reference_inputs_;  ///< spectra of what drives the modes, one for each run
    Eigen::MatrixXf calibration_;
    Eigen::VectorXd calibration_power_;  ///< squared norms of its columns
    Eigen::MatrixXf sides_;              ///< mobile, then fixed side: gain, delay, rotation; to first order
};

}  // namespace wems::identify
