/// @file
/// From what the selection accepted to causes as results name them: values, intervals, probabilities, rivals.
#pragma once

#include <vector>

#include "identify/exact/channel_faults.hpp"
#include "identify/exact/selection.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify {

inline constexpr double kDoubtful = 0.4;  ///< probability of a cause that is not named

/// What the validation runs say of a model.
struct Judgement {
    double error = 0;   ///< of the free simulation
    double misfit = 0;  ///< of what judges, equations or simulation; 1 = noise alone
};

/// Candidates of the same cause at several places become one. Sorted by falling gain.
/// @param without without each accepted candidate
/// @param unexplained a significant part is left: only causes that take away most by themselves keep a probability
/// above one half
std::vector<Cause> makeCauseReports(const Selection& selection, const std::vector<Judgement>& without,
                                    const Judgement& after, bool unexplained);

/// A faulty channel as a cause, in its place by gain; several of one kind become one cause.
/// @param error_ratio validation error with the fault left in over that with it corrected
/// @param unexplained a significant part is left: a fault of a whole side, which rests on the laws, is then not named
/// unless the error without it is much larger
void addSensorCause(const ChannelFault& fault, double error_ratio, bool unexplained, std::vector<Cause>& causes);

}  // namespace wems::identify
