/// @file
/// The least squares of a fit by simulation: Levenberg–Marquardt steps, from a start that may be far off.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/fit/trajectory_problem.hpp"

namespace wems::identify {

/// Levenberg–Marquardt on all pieces together (Marquardt 1963).
class OutputErrorSearch {
public:
    /// @param problem which outlives this @param weights of each run
    OutputErrorSearch(TrajectoryProblem& problem, TrajectoryPoint start, std::vector<double> weights,
                      std::function<void(double error)> report);

    /// Until a step is within a hundredth of the standard errors, or `most` steps.
    void run(int most);

    const TrajectoryPoint& point() const { return point_; }
    const std::vector<double>& weights() const { return weights_; }
    bool settled() const { return settled_; }
    double calcCost() const { return calcCost(residuals_); }
    double countValues() const;
    /// What is left over the motion, RMS.
    double calcError() const;
    /// Weights by what each run leaves: the most likely solution for noise of unknown size in each. Less than a
    /// millionth of the motion is no noise of a recording.
    std::vector<double> weighByResidual() const;

private:
    struct Normal {
        Eigen::MatrixXd information;
        Eigen::VectorXd gradient;
    };
    struct Candidate {
        TrajectoryPoint point;
        std::vector<double> residuals;
    };
    Normal linearise();
    /// One step that lessens the cost. False if there is none.
    bool advance(const Normal& normal);
    std::optional<Candidate> tryStep(const Eigen::VectorXd& change) const;
    double calcSquares(std::size_t piece, const TrajectoryPoint& point) const;
    double weightOf(std::size_t piece) const { return weights_[problem_.pieces()[piece].run]; }
    double calcCost(const std::vector<double>& residuals) const;

    TrajectoryProblem& problem_;
    std::function<void(double)> report_;
    TrajectoryPoint point_;
    std::vector<double> residuals_, weights_;  // squares of each piece, weights of each run
    double damping_ = 1e-3;
    bool settled_ = false;
};

/// A problem, and where its least squares lie. Each part refers to the one before.
struct OutputErrorSolution {
    std::unique_ptr<TrajectoryRuns> runs;
    std::unique_ptr<TrajectoryProblem> problem;
    std::unique_ptr<OutputErrorSearch> search;
};

/// Runs are simulated in pieces of twenty periods. Over two periods each change of a number shows in proportion,
/// however far off the model is; they come first, and pieces grow from there. A whole run would do no better where a
/// device forgets its start within twenty periods (damping of 1 % or more), and could not be followed where stops or
/// hardening make the motion sensitive to its start. Runs on a bracket that is free, or on a base known by its
/// acceleration alone, are whole: their state at the start of a piece is not recorded.
///
/// Steps of the integration are then made so short that they move the values by less than a tenth of their standard
/// errors.
/// @param report step from 1, error so far
/// @throws InputError as fitBySimulation() does, SimulationDiverged
OutputErrorSolution solveOutputError(const std::vector<RunMotion>& motions, const MountModel& model,
                                     const std::vector<std::string>& names,
                                     const std::function<void(int step, double error)>& report);

}  // namespace wems::identify
