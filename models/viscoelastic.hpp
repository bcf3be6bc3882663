/// @file
/// Elastomers by what data sheets say of them: dynamic stiffness and loss factor over frequency, or the spring-pot,
/// whose stiffness is a power of the frequency. Both become a static spring, a dashpot and Maxwell branches, the laws
/// that everything else knows (models/axis_law.hpp).
///
/// With s = iω the stiffness of such a series is
///
///     K(s) = k + c s + Σ_b g_b s τ_b / (1 + s τ_b),      k, c, g_b ≥ 0
///
/// so that no closed cycle gives energy, whatever the sheet said. The time constants lie on a grid, two a decade; the
/// values are those of least relative squares (solveNonNegative()): a relaxation spectrum. Sources: Lakes, Viscoelastic
/// Materials (2009), ch. 2; spring-pot: Bagley and Torvik (1983), doi:10.1122/1.549724.
#pragma once

#include <complex>
#include <vector>

#include "models/axis_law.hpp"

namespace wems {

/// A row of a data sheet: the complex stiffness is stiffness · (1 + i loss_factor).
struct StiffnessRow {
    double frequency = 0;    ///< Hz, > 0
    double stiffness = 0;    ///< N/m, > 0, storage modulus
    double loss_factor = 0;  ///< ≥ 0

    std::complex<double> complexStiffness() const { return {stiffness, stiffness * loss_factor}; }
};

/// K = stiffness · (i f / frequency)^exponent within the band: a loss factor of tan(exponent · π/2) at all of it.
struct SpringPot {
    double stiffness = 0;  ///< N/m, > 0, magnitude at `frequency`
    double exponent = 0;   ///< above 0 (a spring), below 1 (a dashpot)
    double frequency = 0;  ///< Hz, > 0
    Band band{0, 0};       ///< Hz, where it holds

    std::complex<double> complexStiffness(double at_frequency) const;
};

struct ViscoelasticSeries {
    double stiffness = 0;  ///< k, N/m
    double damping = 0;    ///< c, N s/m
    std::vector<MaxwellBranch> branches;
    /// Largest distance from what it was made of, over the magnitude there; NaN if that is beyond all numbers.
    double largest_error = 0;

    std::complex<double> complexStiffness(double frequency) const;
};

/// A series that is farther from its sheet than this is no reading error: no passive series does what the sheet says.
inline constexpr double kLargestSheetError = 0.1;

/// Decades that a sheet or a band may span: with more there would be more than `kMostBranches`.
double mostDecades();

/// @param rows at least one, frequencies ascending, over `mostDecades()` at most
ViscoelasticSeries fitSeries(const std::vector<StiffnessRow>& rows);
ViscoelasticSeries makeSeries(const SpringPot& pot);

}  // namespace wems
