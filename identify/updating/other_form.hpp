/// @file
/// Whether a force that depends on the displacement alone has another form than a cause gives it.
///
/// A cause names a law: a cubic, a spring that is stiffer, a stop. Another elastic law of the same axis, of which the
/// catalogue knows nothing, is told as the one that resembles it most. It leaves something in the equations of motion.
/// A curve of free form (curve_basis.hpp) then takes that away, and the evidence says how much rather it was there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/updating/settling.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

struct OtherForm {
    double log_odds = 0;           ///< of the curve beside the law of the cause, against the law alone
    std::vector<ElasticLaw> laws;  ///< with the curve, of each axis of the cause
};

/// A curve of free form beside the law of a cause's axes, the same at each, by the quadratic about the state. With it
/// or without, the equations are given the size of discrepancy that is left.
///
/// Nothing where the equations are satisfied: the level of the noise is not known so well that a curve could not take
/// some of it. Nothing where the curve does not take half of what is left: something else is at work, which a curve
/// follows here and there. Nothing, too, where the cause says no elastic law, or where its axes stand still, have no
/// elastomer, or have a curve in the model.
/// @param member of the state's set
std::optional<OtherForm> findOtherForm(const TestProblem& problem, const Settler& settler, const SetState& state,
                                       int member);

/// The same at an axis that no cause speaks of: its law as the recordings have it; none for the reasons above, or if
/// the evidence is against it.
/// @param place connection.axis; another is none
std::vector<ElasticLaw> findElasticLaw(const TestProblem& problem, const Settler& settler, const SetState& state,
                                       const std::string& place);

}  // namespace wems::identify::updating
