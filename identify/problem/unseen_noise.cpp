#include "identify/problem/unseen_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wems::identify {
namespace {

constexpr double kBeyond = 2;       // of the highest driven frequency: no drive is meant from there on
constexpr double kPassed = 0.3;     // of the sampling rate, which an anti-alias filter at 0.4 of it passes
constexpr double kLinesBelow = 32;  // of the spectrum below the band: three octaves between what leaks from both ends
constexpr int kLeak = 3;            // lines on each side, of the window of NoiseDensity

/// Variance above the band. The windows are as short as what leaks from the band allows: a stop that is touched in
/// every longer one leaves a quarter of these alone.
double findWhite(const Eigen::MatrixXd& moving, int count, const ExcitedBand& band, double interval, double from,
                 double highest, double resolution, double least) {
    const double widest = std::max(resolution, (from - band.highest) / kLeak);
    return NoiseDensity(moving, count, interval, widest, least).medianBetween(from, highest);
}

/// Of the octaves below the band the least mean of f S(f), unit² Hz as NoiseDensity has it; 0: none is resolved.
double findPink(const NoiseDensity& density, double lowest, double white) {
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
    const double highest = kPassed / interval, from = std::min(kBeyond * band.highest, 0.5 * highest);
    const double above = findWhite(moving, count, band, interval, from, highest, resolution, least);
    const double pink = findPink({moving, count, interval, band.lowest / kLinesBelow, least}, band.lowest, above);
    const double white = std::max(least, above - pink * std::log(highest / from) / (highest - from));
    std::vector<double> variances;
    for (double f = 0; f <= 0.5 / interval; f += resolution)
        variances.push_back(white + pink / std::max(f, resolution));
    return {resolution, variances};
}

}  // namespace wems::identify
