/// @file
/// How relative displacements of a free simulation change with parameters of the model, and whether a run can be
/// predicted at all.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identify/forward/forward_model.hpp"

namespace wems::identify {

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
