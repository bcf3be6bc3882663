/// @file
/// Many parameter sets of one model simulated under one drive: prediction bands, finite differences, campaigns.
///
/// Sets of equal structure (the same stops, branches, frictions and modes; other numbers) run side by side in the lanes
/// of the processor's vector unit, each with its own contacts. The results are those of ForwardModel up to rounding.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/forward/forward_model.hpp"

namespace wems::identify {

class ForwardEnsemble {
public:
    explicit ForwardEnsemble(const std::vector<MountModel>& models);

    std::size_t size() const { return members_.size(); }
    const ForwardModel& member(std::size_t index) const { return *members_[index]; }

    /// Relative displacements of each set (Simulation::q) at all samples of the drive, from rest; an empty matrix where
    /// the motion grew beyond all bounds.
    std::vector<Eigen::MatrixXd> simulate(const Drive& drive) const;
    /// The same for `sample_count` samples from `first_sample` on, from one state for each set.
    std::vector<Eigen::MatrixXd> simulate(const Drive& drive, const std::vector<ForwardState>& initial,
                                          int first_sample, int sample_count) const;

private:
    std::vector<std::unique_ptr<ForwardModel>> members_;
    std::vector<std::vector<std::size_t>> groups_;  // of equal structure
};

// How relative displacements of a free simulation change with parameters of the model, and whether a run can be
// predicted at all.

/// A stretch of a run to differentiate: samples and the state that it starts from (multiple shooting).
struct ShootingWindow {
    int first_sample = 0, sample_count = 0;
    /// Empty: the static equilibrium of the model, which then moves with the parameters.
    std::optional<ForwardState> initial;
};
/// The whole run from rest.
ShootingWindow makeWholeRun(const Drive& drive);

/// Central differences of q (3·connections x samples, one column of the result for each parameter, samples one after
/// the other) with respect to named parameters (models/parameter_access.hpp), per unit of the parameter.
/// @param fraction of parameterScale() by which each parameter is moved both ways; 1e-5 keeps truncation and rounding
///     below 1e-5 of a column where nothing is amplified
/// @throws InputError on a name that the model does not have, SimulationDiverged (with the window's first time)
Eigen::MatrixXd calcJacobian(const MountModel& model, const Drive& drive, const ShootingWindow& window,
                             const std::vector<std::string>& names, double fraction = 1e-5);

/// Relative change of the response (root mean square over the run) over the relative change of a parameter that caused
/// it: about 1 for a run whose peaks follow the parameter, tens near a lightly damped resonance, thousands where
/// deep contact makes the motion chaotic. Where it exceeds about 100, an error of a free simulation says little about
/// the model.
/// @param fraction relative change; small enough that the response has not lost all memory (then the change saturates
///     and the amplification is underestimated)
double calcAmplification(const MountModel& model, const Drive& drive, const std::string& name = "body.mass",
                         double fraction = 1e-5);

}  // namespace wems::identify
