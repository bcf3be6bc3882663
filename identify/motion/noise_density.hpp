/// @file
/// The spectrum of a measurement's noise, from what the measurement shows of itself.
///
/// What the channels of a rigid part show beyond six motions is noise, and what their gains and directions make of the
/// motion. The two are told apart in time: noise is always there, while a sweep passes each frequency once. In each
/// narrow band the lower quartile over short stretches of the recording, divided by what the quartile of that many
/// squared Gaussian values is of their mean, is the noise's density; hum of the mains, which is always there too, is
/// part of it. (Martin 2001, doi:10.1109/89.928915: noise spectra by minimum statistics.)
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace wems::identify {

/// Variance of one channel's sample as white noise of the density at a frequency would have it, unit².
class NoiseDensity {
public:
    /// @param residuals channels x samples: what is noise, and at times more
    /// @param freedom of each sample's values: channels minus fitted motions, ≥ 1
    /// @param resolution Hz, width of a band
    /// @param least variance below which no noise lies (round-off of the file), unit²
    NoiseDensity(const Eigen::MatrixXd& residuals, int freedom, double interval, double resolution, double least);
    /// White noise.
    explicit NoiseDensity(double variance);
    /// @param variances at multiples of the resolution (Hz), at least one
    NoiseDensity(double resolution, std::vector<double> variances)
        : resolution_(resolution), variance_(std::move(variances)) {}

    double resolution() const { return resolution_; }
    const std::vector<double>& variances() const { return variance_; }

    /// Takes what lies below its own resolution from one of a finer resolution, which stays part of it.
    void refine(const NoiseDensity& finer);
    double finerResolution() const { return finer_resolution_; }  ///< Hz; 0: there is none
    const std::vector<double>& finerVariances() const { return finer_; }

    double at(double frequency) const;
    /// Of the bands between two frequencies; that at `to` if there is none.
    double medianBetween(double from, double to) const;
    /// Lets no band below a frequency have more than 1/f noise has there that is as large in the first one from there
    /// on.
    void limitBelow(double frequency);
    /// All of it by a factor.
    void scale(double factor);
    /// Variance of a sample: the mean over all frequencies.
    double variance() const;

private:
    double resolution_ = 0;
    std::vector<double> variance_;  // at k resolution_
    double finer_resolution_ = 0;
    std::vector<double> finer_;  // at k finer_resolution_, up to resolution_
};

/// Of one channel, from what a rigid fit leaves of some of them in eight stretches, and as a whole below what a stretch
/// resolves; white where it leaves nothing.
/// @param residuals channels x samples, `redundancy` equations more than motions
/// @param white RMS of a sample as estimateNoiseFromResiduals() has it; NaN if it is not known
NoiseDensity estimateNoiseDensity(const Eigen::MatrixXd& residuals, int redundancy, double white, double interval);

/// Lower quartile over the mean of a chi-squared variable of `freedom` degrees of freedom (Wilson, Hilferty 1931).
double calcQuartileRatio(double freedom);

}  // namespace wems::identify
