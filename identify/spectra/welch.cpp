#include "identify/spectra/welch.hpp"

#include <cmath>
#include <complex>
#include <vector>

#include "identify/motion/fftw_plan.hpp"
#include "models/error.hpp"
#include "models/pi.hpp"

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
    Eigen::VectorXd block(length);
    Eigen::MatrixXcd transform(bins, count);
    std::vector<std::complex<double>> line(bins);
    const FftwPlan plan(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), block.data(), asFftw(line.data()), FFTW_ESTIMATE));
    CrossSpectra spectra;
    spectra.reference = reference;
    spectra.density = Eigen::MatrixXd::Zero(bins, count);
    spectra.cross = Eigen::MatrixXcd::Zero(bins, count);
    for (Eigen::Index start = 0; start + length <= signals.rows(); start += step, ++spectra.segments) {
        for (Eigen::Index c = 0; c < count; ++c) {
            const auto part = signals.col(c).segment(start, length);
            block = (part.array() - part.mean()) * window.array();
            fftw_execute(plan.get());
            transform.col(c) = Eigen::Map<const Eigen::VectorXcd>(line.data(), bins);
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

}  // namespace wems::identify
