/// @file
/// Quantiles for intervals.
#pragma once

namespace wems::identify {

/// Two-sided 95 % quantile of Student's t, e.g. 1.96 for many degrees of freedom; infinite for fewer than one.
double studentQuantile95(double degrees_of_freedom);

}  // namespace wems::identify
