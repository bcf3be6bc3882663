#include "identify/motion/swept_frequency.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/spectrum.hpp"

namespace wems::identify {
namespace {

constexpr double spectral_limit = 0.01;   // of the maximum density
constexpr double response_limit = 0.001;  // of the maximum density of velocity
constexpr double floor_ratio = 20;        // over the noise floor, what is motion
constexpr Eigen::Index mean_bins = 3;     // bins into which the window spreads the mean
constexpr double hysteresis = 0.5;        // of the local RMS
constexpr double quiet = 0.01;            // local RMS below this part of the highest is no drive
constexpr double noisy = 3;               // times the noise, below which the local RMS is no drive
constexpr double sine_scatter = 0.08;     // median relative scatter of periods of what is a sine
constexpr int smoothing_periods = 5;      // on each side

struct Period {
    double time, log_frequency;
};

/// A scalar signal that shows the drive.
struct DriveSignal {
    Eigen::VectorXd signal;
    Eigen::MatrixXd channels;  // samples x channels, of a response only
    std::string source;
    bool is_response = false;
    double velocity_exponent = 0;  ///< of frequency, that makes the density that of the velocity
};

/// Strongest direction among the channels of the first group that moves at all; empty if none does.
DriveSignal findDrive(const Recording& recording) {
    struct Group {
        Part part;
        Derivative derivative;
        const char* name;
    };
    static const Group groups[] = {{Part::load, Derivative::force, "load"},
                                   {Part::base, Derivative::acceleration, "base"},
                                   {Part::fixed, Derivative::acceleration, "fixed part"},
                                   {Part::fixed, Derivative::velocity, "fixed part"},
                                   {Part::fixed, Derivative::displacement, "fixed part"},
                                   {Part::mobile, Derivative::acceleration, "mobile part"},
                                   {Part::mobile, Derivative::velocity, "mobile part"},
                                   {Part::mobile, Derivative::displacement, "mobile part"}};
    const Eigen::Index samples = recording.sampleCount();
    for (const Group& group : groups) {
        std::vector<const Channel*> channels;
        for (const Channel& channel : recording.channels) {
            const auto name = parseChannelName(channel.name);
            if (name && name->part == group.part && name->derivative == group.derivative) channels.push_back(&channel);
        }
        if (channels.empty()) continue;
        Eigen::MatrixXd values(samples, channels.size());
        for (std::size_t i = 0; i < channels.size(); ++i)
            values.col(i) = Eigen::Map<const Eigen::VectorXd>(channels[i]->values.data(), samples);
        values.rowwise() -= values.colwise().mean().eval();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver((values.transpose() * values).eval());
        if (!(solver.eigenvalues().tail<1>()[0] > 0)) continue;
        DriveSignal drive;
        drive.signal = values * solver.eigenvectors().rightCols<1>();
        drive.source = group.name;
        drive.is_response = group.part == Part::fixed || group.part == Part::mobile;
        if (drive.is_response) drive.channels = values;
        if (group.derivative == Derivative::acceleration) drive.velocity_exponent = -2;
        if (group.derivative == Derivative::displacement) drive.velocity_exponent = 2;
        return drive;
    }
    return {};
}

/// RMS over ±half samples around each sample.
Eigen::VectorXd calcLocalRms(const Eigen::VectorXd& signal, Eigen::Index half) {
    const Eigen::Index n = signal.size();
    Eigen::VectorXd sums(n + 1);
    sums[0] = 0;
    for (Eigen::Index k = 0; k < n; ++k) sums[k + 1] = sums[k] + signal[k] * signal[k];
    Eigen::VectorXd rms(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Eigen::Index first = std::max<Eigen::Index>(0, k - half), last = std::min(n, k + half + 1);
        rms[k] = std::sqrt(std::max(0.0, sums[last] - sums[first]) / static_cast<double>(last - first));
    }
    return rms;
}

/// Full periods between upward crossings of zero; a crossing counts if the signal was below and comes above a part of
/// its local RMS.
std::vector<Period> findPeriods(const std::vector<double>& time, const Eigen::VectorXd& signal, double lowest,
                                double interval) {
    const Eigen::VectorXd rms = calcLocalRms(signal, static_cast<Eigen::Index>(0.75 / (lowest * interval)) + 1);
    const double active = std::max(quiet * rms.maxCoeff(), noisy * estimateNoiseFromSignal(signal));
    std::vector<Period> periods;
    bool low = false, have_last = false;
    double crossing = 0, last = 0;
    for (Eigen::Index k = 1; k < signal.size(); ++k) {
        const std::size_t i = k;
        if (rms[k] < active) {
            low = have_last = false;
            continue;
        }
        if (signal[k] < -hysteresis * rms[k]) low = true;
        if (signal[k - 1] < 0 && signal[k] >= 0)
            crossing = time[i - 1] + (time[i] - time[i - 1]) * signal[k - 1] / (signal[k - 1] - signal[k]);
        if (!low || signal[k] < hysteresis * rms[k]) continue;
        low = false;
        if (have_last && crossing > last) periods.push_back({0.5 * (crossing + last), -std::log(crossing - last)});
        last = crossing;
        have_last = true;
    }
    return periods;
}

/// Local line through the neighbours' log frequencies, those far from their median left out.
double smoothAt(const std::vector<Period>& periods, std::size_t at) {
    const std::size_t first = at > smoothing_periods ? at - smoothing_periods : 0;
    const std::size_t last = std::min(periods.size(), at + smoothing_periods + 1);
    std::vector<double> values, deviations;
    for (std::size_t i = first; i < last; ++i) values.push_back(periods[i].log_frequency);
    const double middle = median(values);
    for (const double value : values) deviations.push_back(std::abs(value - middle));
    const double limit = 4 * median(deviations) + 1e-9;
    double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
    for (std::size_t i = first; i < last; ++i) {
        if (std::abs(periods[i].log_frequency - middle) > limit) continue;
        const double t = periods[i].time - periods[at].time, y = periods[i].log_frequency;
        n += 1, st += t, sy += y, stt += t * t, sty += t * y;
    }
    const double determinant = n * stt - st * st;
    return determinant > 1e-12 * n * stt ? (stt * sy - st * sty) / determinant : middle;
}

/// Lowest and highest frequency where the density is 1 % of its maximum; of a motion 0.1 % of its velocity's, and above
/// the floor of the noise: its low frequencies are weak as accelerations, its high ones as displacements. The floor is
/// the mean above four fifths of half the sampling rate, or what the channels do not share, whichever is more.
void findBand(const DriveSignal& drive, double interval, SweptFrequency& result) {
    Spectrum spectrum = calcSpectrum(drive.signal, interval, 16384);
    // A part may answer each frequency in another direction.
    if (drive.is_response) {
        spectrum.density.setZero();
        for (Eigen::Index i = 0; i < drive.channels.cols(); ++i)
            spectrum.density += calcSpectrum(drive.channels.col(i), interval, 16384).density;
    }
    const Eigen::Index bins = spectrum.density.size() - mean_bins;
    Eigen::VectorXd density = spectrum.density.tail(bins);
    const Eigen::VectorXd frequency = spectrum.frequency.tail(bins);
    Eigen::VectorXd floor = Eigen::VectorXd::Zero(bins);
    if (drive.is_response)
        floor = floor_ratio *
                calcUnsharedDensity(drive.channels, interval, frequency).cwiseMax(density.tail(bins / 5 + 1).mean());
    const Eigen::Array<bool, Eigen::Dynamic, 1> distinct = density.array() > floor.array();
    if (drive.is_response) density = density.array() * frequency.array().pow(drive.velocity_exponent);
    const double limit = (drive.is_response ? response_limit : spectral_limit) * density.maxCoeff();
    for (Eigen::Index i = 0; i < bins; ++i) {
        if (!distinct[i] || density[i] < limit) continue;
        if (result.lowest == 0) result.lowest = frequency[i];
        result.highest = frequency[i];
    }
}

}  // namespace

SweptFrequency findSweptFrequency(const Recording& recording) {
    SweptFrequency result;
    const Eigen::Index samples = recording.sampleCount();
    result.hertz = Eigen::VectorXd::Constant(samples, std::numeric_limits<double>::quiet_NaN());
    if (samples < 16) return result;
    const double interval = recording.sampleInterval();
    const DriveSignal drive = findDrive(recording);
    if (drive.signal.size() == 0) return result;
    result.source = drive.source;

    findBand(drive, interval, result);
    if (!(result.lowest > 0)) return result;
    result.tones = findTones(drive.signal, interval, result.highest, !drive.is_response);
    const std::vector<Period> periods = findPeriods(recording.time, drive.signal, result.lowest, interval);
    if (periods.size() < 4) return result;
    std::vector<double> smoothed(periods.size()), scatter(periods.size());
    for (std::size_t i = 0; i < periods.size(); ++i) {
        smoothed[i] = smoothAt(periods, i);
        scatter[i] = std::abs(periods[i].log_frequency - smoothed[i]);
    }
    result.is_sine = result.tones.empty() && median(scatter) < sine_scatter;
    if (!result.is_sine) return result;

    const double lowest = std::exp(*std::min_element(smoothed.begin(), smoothed.end()));
    // What a part does need not be what drives it: its own spectrum may reach lower.
    result.lowest = drive.is_response && result.lowest > 0 ? std::min(result.lowest, lowest) : lowest;
    result.highest = std::exp(*std::max_element(smoothed.begin(), smoothed.end()));
    std::size_t i = 0;
    for (Eigen::Index k = 0; k < samples; ++k) {
        const double t = recording.time[k];
        while (i + 2 < periods.size() && periods[i + 1].time < t) ++i;
        const double span = periods[i + 1].time - periods[i].time;
        const double share = std::clamp((t - periods[i].time) / span, 0.0, 1.0);
        result.hertz[k] = std::exp((1 - share) * smoothed[i] + share * smoothed[i + 1]);
    }
    return result;
}

}  // namespace wems::identify
