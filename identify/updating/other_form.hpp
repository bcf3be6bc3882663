/// @file
/// Whether a force that depends on the displacement alone has another form than a cause gives it.
///
/// A cause names a law: a cubic, a spring that is stiffer, a stop. Another elastic law of the same axis, of which the
/// catalogue knows nothing, is told as the one that resembles it most. It leaves something in the equations of motion.
/// A curve of free form (curve_basis.hpp) then takes that away, and the evidence says how much rather it was there.
#pragma once

#include <optional>

#include "identify/updating/settling.hpp"

namespace wems::identify::updating {

/// Log odds of a curve of free form beside the law of a cause's axes, the same at each, against the law alone, by the
/// quadratic about the state. Either is given the size of discrepancy that it leaves.
///
/// Nothing where the equations are satisfied: the level of the noise is not known so well that a curve could not take
/// some of it. Nothing where the curve does not take half of what is left: something else is at work, which a curve
/// follows here and there. Nothing, too, where the cause says no elastic law, or such an axis has a curve in the model.
/// @param member of the state's set
std::optional<double> calcOtherFormOdds(const TestProblem& problem, const Settler& settler, const SetState& state,
                                        int member);

}  // namespace wems::identify::updating
