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

    double at(double frequency) const;
    /// Of the bands between two frequencies; that at `to` if there is none.
    double medianBetween(double from, double to) const;
    /// Gives all bands below a frequency what the first one from there on has.
    void levelBelow(double frequency);
    /// All of it by a factor.
    void scale(double factor);
    /// Variance of a sample: the mean over all frequencies.
    double variance() const;

private:
    double resolution_ = 0;
    std::vector<double> variance_;  // at k resolution_
};

/// Lower quartile over the mean of a chi-squared variable of `freedom` degrees of freedom (Wilson, Hilferty 1931).
double calcQuartileRatio(double freedom);

// Velocities without the noise that differentiation makes of a displacement's, for laws that turn on the sign of the
// velocity: noise of 2 µm up to 300 Hz is 2 mm/s, while friction that sticks creeps at less.

/// Wiener filter over short-time spectra (overlapping frames): what lies below twice the noise in a stretch and
/// a band goes, the rest loses the noise's share of its power. Zero phase. (Oppenheim, Verghese, Signals, Systems and
/// Inference, 2016, ch. 12; Lim, Oppenheim 1979, doi:10.1109/PROC.1979.11540.)
/// @param frame samples of a frame, as velocityNoiseFrame() gives it
/// @param velocities rows of samples `interval` (s) apart, m/s
/// @param density one-sided noise density of each row at k/(n interval), n = frame,
///     (m/s)²/Hz: rows x (n/2 + 1)
Eigen::MatrixXd removeVelocityNoise(const Eigen::MatrixXd& velocities, int frame, double interval,
                                    const Eigen::MatrixXd& density);
/// Two and a half periods of the lowest excited frequency (Hz).
int velocityNoiseFrame(double interval, double lowest);

}  // namespace wems::identify
