#include "identify/verdict/driven_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <random>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/fourier.hpp"
#include "identify/motion/parallel.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

// Each costs a simulation. Twenty draws on three runs against a hard stop: the RMS of four was 0.4 to 2.0 times that of
// all, of two 0.2 to 2.5 times.
constexpr std::size_t kNoiseDraws = 4;
// Of the lowest and the highest excited frequency: an octave beyond what was driven, since a mount lies within it or
// near. Not varied.
constexpr double kFromLowest = 0.5, kToHighest = 2;

/// A noise and its derivatives, along one axis.
struct DrawnNoise {
    Eigen::RowVectorXd value, rate, second;
};

/// Harmonics of random phase with the one-sided density (unit²/Hz) at each frequency.
template <class Density>
DrawnNoise drawNoise(const RunMotion& run, const DriveNoise& noise, const Density& density, std::mt19937_64& random) {
    const auto samples = static_cast<int>(run.time.size());
    const Fourier fourier(samples);
    const double spacing = 1 / (fourier.size() * run.interval);
    const auto first = static_cast<Eigen::Index>(std::ceil(kFromLowest * noise.lowest / spacing));
    const auto last =
        std::min<Eigen::Index>(fourier.binCount() - 2, static_cast<Eigen::Index>(kToHighest * noise.highest / spacing));
    Eigen::MatrixXcd spectra = Eigen::MatrixXcd::Zero(3, fourier.binCount());
    std::uniform_real_distribution<double> phase(0, kTwoPi);
    for (Eigen::Index k = std::max<Eigen::Index>(1, first); k <= last; ++k) {
        const double frequency = static_cast<double>(k) * spacing, w = kTwoPi * frequency;
        // Half the amplitude on each side of zero.
        const double half = 0.5 * std::sqrt(2 * density(frequency) * spacing) * fourier.size();
        const std::complex<double> value = std::polar(half, phase(random));
        spectra.col(k) << value, std::complex<double>(0, w) * value, -w * w * value;
    }
    const Eigen::MatrixXd rows = fourier.inverse(spectra, samples);
    return {rows.row(0), rows.row(1), rows.row(2)};
}

/// The run with a draw of the noise in what drives it.
RunMotion drawDrive(const FreeRun& free, unsigned seed) {
    RunMotion run = *free.motion;
    const DriveNoise& noise = free.drive;
    std::mt19937_64 random(seed);
    const double twice = 2 * run.interval;  // one-sided density of a sampled white noise over its variance
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        if (noise.displacement || noise.acceleration) {
            // Of what both kinds of channel say together.
            const DrawnNoise drawn = drawNoise(
                run, noise,
                [&](double frequency) {
                    double precision = 0;
                    if (noise.displacement) precision += 1 / (twice * noise.displacement->at(frequency));
                    if (noise.acceleration)
                        precision += std::pow(kTwoPi * frequency, 4) / (twice * noise.acceleration->at(frequency));
                    return 1 / precision;
                },
                random);
            run.fixed.p.row(axis) += drawn.value;
            run.fixed.v.row(axis) += drawn.rate;
            run.fixed.a.row(axis) += drawn.second;
        }
        const auto addTo = [&](Eigen::Matrix3Xd& rows, const std::optional<NoiseDensity>& density) {
            if (rows.cols() == 0 || !density) return;
            rows.row(axis) += drawNoise(
                                  run, noise, [&](double frequency) { return twice * density->at(frequency); }, random)
                                  .value;
        };
        addTo(run.base, noise.base);
        addTo(run.load, noise.load);
    }
    return run;
}

/// Whether calcNoiseVariance() has what the fixed part's noise makes of the measured displacements. A motion that is
/// integrated from channels without redundancy has a noise that it does not know.
bool isCounted(const RunMotion& run) {
    return run.fixed.displacement_measured || std::isfinite(run.fixed.acceleration_noise);
}

}  // namespace

DrivenNoise calcDrivenNoise(const FreeRun& run, const MountModel& model, unsigned seed) {
    std::array<std::optional<double>, kNoiseDraws> squares;
    try {
        const Eigen::MatrixXd reference = calcFreeResidual(run, model);
        runParallel(kNoiseDraws, [&](std::size_t d) {
            const RunMotion drawn = drawDrive(run, seed + static_cast<unsigned>(d));
            FreeRun other = run;
            other.motion = &drawn;
            if (!isCounted(*run.motion))
                for (Eigen::Index row = 0; row < run.measured.rows(); ++row)
                    other.measured.row(row) -= drawn.fixed.p.row(row % 3) - run.motion->fixed.p.row(row % 3);
            try {
                squares.at(d) = (calcFreeResidual(other, model) - reference).squaredNorm();
            } catch (const SimulationDiverged&) {  // has no size
            }
        });
    } catch (const SimulationDiverged&) {
        return {};
    }
    const auto values = static_cast<double>(std::max<Eigen::Index>(1, run.measured.size()));
    double sum = 0, of_squares = 0;
    int count = 0;
    for (const std::optional<double>& square : squares) {
        if (!square) continue;
        const double mean = *square / values;
        sum += mean;
        of_squares += mean * mean;
        ++count;
    }
    if (count == 0) return {};
    const double mean = sum / count;
    // One draw alone says nothing of its scatter: its square may be all.
    const double variance = count > 1 ? (of_squares - count * mean * mean) / (count - 1) : mean * mean;
    return {mean, std::sqrt(std::max(0.0, variance))};
}

}  // namespace wems::identify
