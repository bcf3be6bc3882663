/// @file
/// The diagnosis of a residual problem: errors, causes with their probabilities and rivals, adjustments, band.
#pragma once

#include "identify/residual/residual_search.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify {

/// All but the extended model, the verdict and the place of what is left. The causes' parameters are named as the rows
/// of the table.
struct ResidualDiagnosis {
    Diagnosis diagnosis;
    ResidualAnswer answer;
};
ResidualDiagnosis diagnoseResidual(const ResidualProblem& problem, const DiagnosisOptions& options);

/// Contract, section 6: more than the band, the noise and what is worth naming.
bool isLeft(const Diagnosis& diagnosis);
/// `unexplained` where something is left, `explained` where causes lower the error, else `nothing_missing`.
Diagnosis::Verdict judgeVerdict(const Diagnosis& diagnosis);

/// 20 log10 of a ratio of errors, within 120 dB.
double toDecibel(double ratio);

}  // namespace wems::identify
