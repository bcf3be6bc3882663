/// @file
/// Whether a fitted law answers for the force that was measured (contract, section 6).
#pragma once

#include <string>

namespace wems::identify {

enum class LawVerdict {
    identified,  ///< leaves no more than the noise, or less than a data sheet would
    doubtful,    ///< describes most of the force; something is missing
    unexplained  ///< no answer: the values describe a law that this is not
};

/// @param residual_fraction RMS of the force that is left over that of the force
/// @param over_noise RMS of what is left over that of the noise; infinite if the noise is not known
LawVerdict judgeLaw(double residual_fraction, double over_noise);

/// `identified`, `doubtful`, `unexplained`
std::string formatLawVerdict(LawVerdict verdict);
/// A sentence for the reader of a table.
std::string describeLawVerdict(LawVerdict verdict);

}  // namespace wems::identify
