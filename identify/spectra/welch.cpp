#include "identify/spectra/welch.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "identify/motion/real_transform.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

/// 2 K / (1 + 2 Σ_j (1 − j/K) ρ_j), ρ_j the squared correlation of the windows of segments j apart.
double calcDegreesOfFreedom(const Eigen::VectorXd& window, Eigen::Index step, Eigen::Index segments) {
    const double power = window.squaredNorm();
    double sum = 0;
    for (Eigen::Index j = 1; j < segments && j * step < window.size(); ++j) {
        const Eigen::Index shared = window.size() - j * step;
        const double overlap = window.head(shared).dot(window.tail(shared)) / power;
        sum += (1 - static_cast<double>(j) / static_cast<double>(segments)) * overlap * overlap;
    }
    return 2 * static_cast<double>(segments) / (1 + 2 * sum);
}

}  // namespace

Eigen::Index chooseSegment(Eigen::Index samples, int averages) {
    constexpr Eigen::Index shortest = 8;
    Eigen::Index segment = shortest;
    // K half-overlapping segments of length L take (K + 1) L/2 samples.
    while ((averages + 1) * segment <= samples) segment *= 2;
    return segment;
}

CrossSpectra estimateSpectra(const Eigen::MatrixXd& signals, Eigen::Index reference, double interval,
                             const WelchSettings& settings) {
    const Eigen::Index length = settings.segment, step = length - length / 2, count = signals.cols();
    if (length < 8 || length > signals.rows())
        throw InputError({}, "a segment of " + std::to_string(length) + " samples does not fit",
                         "8 to " + std::to_string(signals.rows()) + " samples");
    Eigen::VectorXd window(length);
    for (Eigen::Index i = 0; i < length; ++i)
        window[i] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(i) / static_cast<double>(length));

    const Eigen::Index bins = length / 2 + 1;
    const RealTransform fourier(length);
    Eigen::MatrixXcd transform(bins, count);
    CrossSpectra spectra;
    spectra.reference = reference;
    spectra.density = Eigen::MatrixXd::Zero(bins, count);
    spectra.cross = Eigen::MatrixXcd::Zero(bins, count);
    for (Eigen::Index start = 0; start + length <= signals.rows(); start += step, ++spectra.segments) {
        for (Eigen::Index c = 0; c < count; ++c) {
            const auto part = signals.col(c).segment(start, length);
            transform.col(c) = fourier.forward(((part.array() - part.mean()) * window.array()).matrix());
        }
        spectra.density += transform.cwiseAbs2();
        for (Eigen::Index c = 0; c < count; ++c)
            spectra.cross.col(c) += transform.col(reference).conjugate().cwiseProduct(transform.col(c));
    }
    // One-sided: twice, but for 0 and, where there is a bin for it, half the sampling rate.
    Eigen::VectorXd scale =
        Eigen::VectorXd::Constant(bins, 2 * interval / (window.squaredNorm() * static_cast<double>(spectra.segments)));
    scale[0] /= 2;
    if (length % 2 == 0) scale[bins - 1] /= 2;
    spectra.density = scale.asDiagonal() * spectra.density;
    spectra.cross = scale.cast<std::complex<double>>().asDiagonal() * spectra.cross;
    spectra.resolution = 1 / (interval * static_cast<double>(length));
    spectra.frequency = Eigen::VectorXd::LinSpaced(bins, 0, static_cast<double>(bins - 1) * spectra.resolution);
    spectra.degrees_of_freedom = calcDegreesOfFreedom(window, step, spectra.segments);
    return spectra;
}

namespace {

constexpr double kOutside = 0.05;  // of an interval of 95 %

double quotient(double a, double b) {
    return b > 0 ? a / b : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

TransferEstimate estimateTransfer(const CrossSpectra& spectra, Eigen::Index output) {
    const Eigen::Index bins = spectra.frequency.size();
    const double nu = spectra.degrees_of_freedom;
    const double spread = nu > 2 ? std::pow(kOutside, -2 / (nu - 2)) - 1 : std::numeric_limits<double>::infinity();
    TransferEstimate estimate;
    estimate.h1.resize(bins);
    estimate.h2.resize(bins);
    estimate.hv.resize(bins);
    estimate.coherence.resize(bins);
    estimate.radius95.resize(bins);
    for (Eigen::Index k = 0; k < bins; ++k) {
        const double xx = spectra.density(k, spectra.reference), yy = spectra.density(k, output);
        const std::complex<double> xy = spectra.cross(k, output);
        const double square = std::norm(xy);
        estimate.h1[k] = xy * quotient(1, xx);
        estimate.h2[k] = xy * quotient(yy, square);
        estimate.hv[k] = xy * std::sqrt(quotient(yy, xx) * quotient(1, square));
        estimate.coherence[k] = quotient(square, xx * yy);
        estimate.radius95[k] = std::sqrt(spread * std::fmax(0, 1 - estimate.coherence[k]) * quotient(yy, xx));
    }
    return estimate;
}

double coherenceThreshold95(double degrees_of_freedom) {
    return degrees_of_freedom > 2 ? 1 - std::pow(kOutside, 2 / (degrees_of_freedom - 2)) : 1;
}

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
