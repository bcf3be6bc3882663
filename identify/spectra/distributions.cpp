#include "identify/spectra/distributions.hpp"

#include <cmath>

namespace wems::identify {
namespace {

/// Regularised lower incomplete gamma function P(a, x): series below a + 1, continued fraction (Lentz) above.
/// Source: Press et al., Numerical Recipes (2007), section 6.2.
double lowerGamma(double a, double x) {
    if (!(x > 0)) return 0;
    constexpr int most_terms = 10000;
    constexpr double small = 1e-300, converged = 1e-16;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (int n = 1; n < most_terms && term > converged * sum; ++n) {
            term *= x / (a + n);
            sum += term;
        }
        return front * sum;
    }
    double b = x + 1 - a, c = 1 / small, d = 1 / b, h = d;
    for (int n = 1; n < most_terms; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = an * d + b;
        if (std::abs(d) < small) d = small;
        c = b + an / c;
        if (std::abs(c) < small) c = small;
        d = 1 / d;
        h *= d * c;
        if (std::abs(d * c - 1) < converged) break;
    }
    return 1 - front * h;
}

}  // namespace

double chiSquareQuantile(double degrees_of_freedom, double p) {
    const double a = degrees_of_freedom / 2;
    double low = 0, high = a + 1;
    while (lowerGamma(a, high) < p) high *= 2;
    constexpr int halvings = 200;
    constexpr double precise = 1e-13;
    for (int i = 0; i < halvings && high - low > precise * high; ++i) {
        const double middle = 0.5 * (low + high);
        (lowerGamma(a, middle) < p ? low : high) = middle;
    }
    return low + high;  // twice the middle: χ² = 2 x
}

DensityInterval densityInterval95(double degrees_of_freedom) {
    return {degrees_of_freedom / chiSquareQuantile(degrees_of_freedom, 0.975),
            degrees_of_freedom / chiSquareQuantile(degrees_of_freedom, 0.025)};
}

}  // namespace wems::identify
