#include "identify/verdict/driven_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/parallel.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

// Their mean square is within a third of that of many draws, which is within a sixth of the noise.
constexpr std::size_t kNoiseDraws = 4;
// Harmonics of a drawn noise: so many that in the width of a resonance of 1 % over two decades lies one.
constexpr int kNoiseHarmonics = 400;
constexpr double kFromLowest = 0.5, kToHighest = 2;  // of the lowest and the highest excited frequency

/// A noise and its integrals, along one axis.
struct DrawnNoise {
    Eigen::RowVectorXd value, rate, second;
};

/// Harmonics of the one-sided density (unit²/Hz) at each frequency.
template <class Density>
DrawnNoise drawNoise(const RunMotion& run, const DriveNoise& noise, const Density& density, std::mt19937_64& random) {
    const auto samples = static_cast<Eigen::Index>(run.time.size());
    DrawnNoise drawn{Eigen::RowVectorXd::Zero(samples), Eigen::RowVectorXd::Zero(samples),
                     Eigen::RowVectorXd::Zero(samples)};
    std::uniform_real_distribution<double> phase(0, kTwoPi);
    const double lower = kFromLowest * noise.lowest, upper = std::min(kToHighest * noise.highest, 0.5 / run.interval);
    const double ratio = std::log(upper / lower) / kNoiseHarmonics;
    for (int j = 0; j < kNoiseHarmonics; ++j) {
        const double frequency = lower * std::exp(ratio * (j + 0.5)), w = kTwoPi * frequency;
        const double amplitude = std::sqrt(2 * density(frequency) * frequency * ratio);
        // Turned from sample to sample.
        const double start = phase(random);
        double sine = amplitude * std::sin(start), cosine = amplitude * std::cos(start);
        const double s = std::sin(w * run.interval), c = std::cos(w * run.interval);
        for (Eigen::Index k = 0; k < samples; ++k) {
            drawn.value[k] += sine;
            drawn.rate[k] += w * cosine;
            drawn.second[k] -= w * w * sine;
            const double next = sine * c + cosine * s;
            cosine = cosine * c - sine * s;
            sine = next;
        }
    }
    return drawn;
}

/// The run with a draw of the noise in what drives it.
RunMotion drawDrive(const FreeRun& free, unsigned seed) {
    RunMotion run = *free.motion;
    const DriveNoise& noise = free.drive;
    std::mt19937_64 random(seed);
    const double twice = 2 * run.interval;  // one-sided density of a sampled white noise over its variance
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        if (noise.displacement > 0 || noise.acceleration > 0) {
            // Of what both kinds of channel say together.
            const DrawnNoise drawn = drawNoise(
                run, noise,
                [&](double frequency) {
                    double precision = 0;
                    if (noise.displacement > 0) precision += 1 / (twice * noise.displacement);
                    if (noise.acceleration > 0)
                        precision += std::pow(kTwoPi * frequency, 4) / (twice * noise.acceleration);
                    return 1 / precision;
                },
                random);
            run.fixed.p.row(axis) += drawn.value;
            run.fixed.v.row(axis) += drawn.rate;
            run.fixed.a.row(axis) += drawn.second;
        }
        const auto addTo = [&](Eigen::Matrix3Xd& rows, double variance) {
            if (rows.cols() == 0 || !(variance > 0)) return;
            rows.row(axis) += drawNoise(
                                  run, noise, [&](double) { return twice * variance; }, random)
                                  .value;
        };
        addTo(run.base, noise.base);
        addTo(run.load, noise.load);
    }
    return run;
}

}  // namespace

double calcDrivenVariance(const FreeRun& run, const MountModel& model, unsigned seed) {
    std::array<double, kNoiseDraws> squares{};
    try {
        const Eigen::MatrixXd reference = calcFreeResidual(run, model);
        runParallel(kNoiseDraws, [&](std::size_t d) {
            const RunMotion drawn = drawDrive(run, seed + static_cast<unsigned>(d));
            FreeRun other = run;
            other.motion = &drawn;
            squares.at(d) = (calcFreeResidual(other, model) - reference).squaredNorm();
        });
    } catch (const SimulationDiverged&) {
        return std::numeric_limits<double>::infinity();
    }
    double sum = 0;
    for (const double square : squares) sum += square / kNoiseDraws;
    return sum / static_cast<double>(std::max<Eigen::Index>(1, run.measured.size()));
}

}  // namespace wems::identify
