/// @file
/// Quantiles that intervals of spectra need.
#pragma once

namespace wems::identify {

/// x with P(χ²_ν ≤ x) = p, to 1e-12. @param degrees_of_freedom above 0 @param p within (0, 1)
double chiSquareQuantile(double degrees_of_freedom, double p);

/// The factors by which a 95 % interval of a spectral density lies below and above its estimate: ν/χ²_{0.975} and
/// ν/χ²_{0.025}. Source: Bendat, Piersol, Random Data (2010), eq. 8.159.
struct DensityInterval {
    double lower, upper;
};
DensityInterval densityInterval95(double degrees_of_freedom);

}  // namespace wems::identify
