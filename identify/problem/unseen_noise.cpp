#include "identify/problem/unseen_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace wems::identify {
namespace {

constexpr double kBeyond = 2;       // of the highest driven frequency: no drive is meant from there on
constexpr double kPassed = 0.3;     // of the sampling rate, which an anti-alias filter at 0.4 of it passes
constexpr double kLinesBelow = 32;  // of the spectrum below the band: three octaves between what leaks from both ends
constexpr int kLeak = 3;            // lines on each side, of the window of NoiseDensity

// Standard deviations: as much of the noise above the band as chance hides in 98 of 100 cases may fall as 1/f.
constexpr double kDoubt = 2;
// Relative scatter of NoiseDensity's power between two frequencies, times the root of how many independent values are
// there: 1.4 to 1.7 (white noise of one channel and of three, windows of 60 and 240 samples, 200 draws each).
constexpr double kScatter = 1.7;

/// Of 1/f between two frequencies.
double calcMeanInverse(double from, double to) {
    return std::log(to / from) / (to - from);
}

/// The noise between two frequencies above the band.
struct NoiseAbove {
    double from, highest;
    NoiseDensity density;
    double values;  ///< independent ones in a Hz

    double power() const { return density.medianBetween(from, highest); }

    /// As much of it as may fall as 1/f: what its lower half has more than the upper one, unit² Hz.
    double findPink() const {
        const double middle = std::sqrt(from * highest);
        const double lower = density.medianBetween(from, middle), upper = density.medianBetween(middle, highest);
        const double doubt = kDoubt * kScatter / std::sqrt(values) *
                             std::hypot(lower / std::sqrt(middle - from), upper / std::sqrt(highest - middle));
        return std::max(0.0, lower - upper + doubt) /
               (calcMeanInverse(from, middle) - calcMeanInverse(middle, highest));
    }
};

/// Long windows tell the mains' lines from the noise between them. Short ones tell it from a stop that is touched in
/// every longer one. What shows least is nearest to the noise.
NoiseAbove findAbove(const Eigen::MatrixXd& moving, int count, const ExcitedBand& band, double interval,
                     double resolution, double least) {
    const double highest = kPassed / interval, from = std::min(kBeyond * band.highest, 0.5 * highest);
    const double values = count * static_cast<double>(moving.cols()) * interval;
    const double widest = (from - band.highest) / kLeak;  // that what leaks from the band allows
    NoiseAbove best{from, highest, {moving, count, interval, resolution, least}, values};
    for (double width = 2 * resolution; width <= widest; width *= 2) {
        NoiseAbove other{from, highest, {moving, count, interval, width, least}, values};
        if (other.power() < best.power()) best = std::move(other);
    }
    return best;
}

/// Of the octaves below the band the least mean of f S(f), unit² Hz as NoiseDensity has it; 0: none is resolved.
double findPinkBelow(const NoiseDensity& density, double lowest, double white) {
    const double spacing = density.resolution();
    const auto& variances = density.variances();
    double least = 0;
    bool found = false;
    auto above = static_cast<int>(lowest / spacing) - kLeak;
    for (int below = above / 2; below >= kLeak; above = below, below /= 2) {
        double sum = 0;
        for (int k = below; k < above; ++k) sum += k * spacing * std::max(0.0, variances[k] - white);
        const double mean = sum / (above - below);
        least = found ? std::min(least, mean) : mean;
        found = true;
    }
    return least;
}

}  // namespace

NoiseDensity estimateNoiseBesideBand(const Eigen::MatrixXd& values, int count, const ExcitedBand& band, double interval,
                                     double resolution, double least) {
    const Eigen::MatrixXd moving = values.colwise() - values.rowwise().mean();
    const NoiseAbove above = findAbove(moving, count, band, interval, resolution, least);
    const double power = above.power();
    const double pink =
        std::min(above.findPink(),
                 findPinkBelow({moving, count, interval, band.lowest / kLinesBelow, least}, band.lowest, power));
    const double white = std::max(least, power - pink * calcMeanInverse(above.from, above.highest));
    std::vector<double> variances;
    for (double f = 0; f <= 0.5 / interval; f += resolution)
        variances.push_back(white + pink / std::max(f, resolution));
    return {resolution, variances};
}

}  // namespace wems::identify
