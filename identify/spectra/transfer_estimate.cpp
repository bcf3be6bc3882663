#include "identify/spectra/transfer_estimate.hpp"

#include <cmath>
#include <limits>

namespace wems::identify {
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

}  // namespace wems::identify
