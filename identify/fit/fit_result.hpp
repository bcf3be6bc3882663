/// @file
/// From the solution of the regression to what a user is told: known values, open groups, the fitted model.
#pragma once

#include "identify/fit/fit.hpp"
#include "identify/fit/identifiability.hpp"
#include "identify/fit/intervals.hpp"
#include "identify/fit/solver.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

/// Fills parameters, not_identifiable, residual_fraction, model and notes of `result`.
void fillResult(Solver& solver, const LinearSystem& system, const ParameterUncertainty& uncertainty,
                const FitOptions& options, FitResult& result);

}  // namespace wems::identify
