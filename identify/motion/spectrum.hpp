/// @file
/// Power spectral density of a signal, and double integration in the frequency domain.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems::identify {

struct Spectrum {
    Eigen::VectorXd frequency;  ///< Hz, from 0 to half the sampling rate
    Eigen::VectorXd density;    ///< unit²/Hz, one-sided
};

/// Welch's method: Hann segments with half overlap, at most `segment` samples each (a power of two).
Spectrum calcSpectrum(const Eigen::VectorXd& signal, double interval, int segment = 8192);

/// Density (unit²/Hz, one-sided) of what the channels (samples x channels) of a rigid part do not share, the sum over
/// all: six motions fill six dimensions at each frequency, noise of equal size fills them all. From the smaller
/// eigenvalues of the channels' cross-spectra over at least twice as many neighbouring bins as channels; below the
/// first such stretch it is continued as 1 / f, which noise of electronics may be. All zero for six channels or fewer.
Eigen::VectorXd calcUnsharedDensity(const Eigen::MatrixXd& channels, double interval, const Eigen::VectorXd& frequency);

/// Gain of a high pass at a frequency (Hz): it rises from 0 at 2/3 of `lowest` to 1 there as a raised cosine.
double calcHighPassGain(double frequency, double lowest);

struct IntegratedSignal {
    Eigen::VectorXd v, x;
};

/// Integrates an acceleration once and twice, zero-phase, through that high pass: exact from `lowest` (Hz) on. The
/// signal is continued by zeros, so the recording should begin and end at rest.
IntegratedSignal integrateTwice(const Eigen::VectorXd& acceleration, double interval, double lowest);

/// The signal through that high pass, its mean removed. The ends are continued by point reflection.
Eigen::VectorXd highPass(const Eigen::VectorXd& signal, double interval, double lowest);

struct SlowSignal {
    Eigen::VectorXd x, rate;
};

/// The part of a signal below a frequency, zero-phase, and its derivative: gain 1 up to `pass`, 0 from `stop` (Hz) on,
/// a raised cosine between. The signal is continued by zeros.
SlowSignal keepSlowPart(const Eigen::VectorXd& signal, double interval, double pass, double stop);

// Several sines at once.

/// Frequencies (Hz, ascending) of two to twelve lines that a signal consists of and that last together; empty for
/// anything else: one sine, a sweep, steps from one frequency to the next, random.
///
/// Lines are narrow islands in the spectrum of the whole signal that hold most of its power, each at least 4 % of the
/// strongest (a fifth of its amplitude); nearer to each other than about seven over the duration they count as one.
/// Their powers over time must overlap by half.
/// @param harmonics_count false: lines at multiples of the lowest are what a part makes of one sine
/// @param highest frequency of the drive, Hz, as far as it is known
std::vector<double> findTones(const Eigen::VectorXd& signal, double interval, double highest, bool harmonics_count);

}  // namespace wems::identify
