#include "identify/inspect/channel_cells.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/real_transform.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

std::vector<std::vector<std::complex<double>>> transformSegments(const std::vector<double>& signal,
                                                                 std::size_t length) {
    Eigen::VectorXd block(length);
    const RealTransform transform(block.size());
    std::vector<std::vector<std::complex<double>>> segments;
    for (std::size_t start = 0; start + length <= signal.size(); start += length / 2) {
        for (std::size_t i = 0; i < length; ++i) {
            const double phase = kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(length);
            const double value = signal[start + i];
            block[i] = std::isfinite(value) ? (0.5 - 0.5 * std::cos(phase)) * value : 0;
        }
        const Eigen::VectorXcd bins = transform.forward(block);
        segments.emplace_back(bins.begin(), bins.end());
    }
    return segments;
}

namespace {

// Measured on recordings of 24 random devices without fault, small errors of every sensor (38 parts): with the values
// in brackets in place of a constant the median misfit (fault_misfit.hpp), 0.46, changes by 10 % at most.

/// m: angular accelerations times this stand beside translations, a scale alone (0.01 and 1: no change).
constexpr double kArm = 0.1;
/// Half-overlapping segments of a recording, so that each end of a clock that drifts has several (12, 48).
constexpr std::size_t kSegmentsWanted = 24;
/// Samples of a segment, a power of two: three of the 32 bins that are then used are still a tenth of the band (64).
constexpr std::size_t kLeastLength = 128;
/// Bins of a cell: a line through Hann's window is four wide between its zeros, two at half its height.
constexpr std::size_t kFewestBins = 3;
/// Width of a cell over its frequency: a delay of 10 ms turns its ends by 0.24 rad against its middle at 50 Hz
/// (0.05, 0.3).
constexpr double kBandWidth = 0.15;
/// Bins below: Hann's window spreads an offset over the first two, and of a drift it leaves 2 % at this one (1).
constexpr std::size_t kFirstUsed = 4;
/// Of the power of its segment, for a cell to count: of a sweep the band that it passes, not what leaks beside it. With
/// 0.01 a tenth of the parts has a misfit above 1.02, with 0.05 above 0.79, with 0.2 above 0.76.
constexpr double kLeastCellShare = 0.05;
/// Of the strongest cell's power: weaker cells hold more of noise and leakage. With 1e-5 the median rises by 10 %.
constexpr double kLeastPower = 1e-3;
/// Power over that of the noise, for a bin to tell of motion: noise alone has four times its mean in exp(-4) = 2 % of
/// the bins (1, 16).
constexpr double kAboveNoise = 4;
/// Of half the sampling rate: filters before sampling differ above, and the second difference's gain falls below 0.81
/// (0.25, 0.9).
constexpr double kHighestUsed = 0.5;
/// Cells at most, to which the time of a search is in proportion (12). Of 60 faults in 24 recordings 45 are named with
/// 48 cells in 1.3 s a recording, 48 with 12 in 0.46 s; but 12 leave a clock that drifts few cells at its ends.
constexpr std::size_t kMostCells = 48;
/// Mean square of Hann's window.
constexpr double kHannPower = 3.0 / 8;

using Spectra = std::vector<std::vector<std::complex<double>>>;  // segments of bins

/// Second differences over the interval squared, zero at the ends.
std::vector<double> differTwice(const std::vector<double>& x, double interval) {
    std::vector<double> result(x.size(), 0.0);
    for (std::size_t k = 1; k + 1 < x.size(); ++k) result[k] = (x[k - 1] - 2 * x[k] + x[k + 1]) / (interval * interval);
    return result;
}

/// ω² over the gain of the second difference at ω.
double correctDifference(double omega, double interval) {
    const double half = 0.5 * omega * interval, ratio = half / std::sin(half);
    return ratio * ratio;
}

void addBase(const Recording& recording, std::vector<CellChannel>& channels,
             std::vector<const std::vector<double>*>& values) {
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part != Part::base || name->derivative != Derivative::acceleration) continue;
        CellChannel entry{channel.name, "base", Derivative::acceleration, name->axis, {}};
        entry.row.setZero();
        entry.row[name->axis] = 1;
        channels.push_back(entry);
        values.push_back(&channel.values);
    }
}

class CellMaker {
public:
    CellMaker(const Recording& recording, const std::vector<CellChannel>& channels,
              const std::vector<const std::vector<double>*>& values)
        : interval_(recording.sampleInterval()), channels_(channels) {
        while (length_ * kSegmentsWanted / 2 < recording.sampleCount()) length_ *= 2;
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const bool differs = channels[c].derivative == Derivative::displacement;
            const Eigen::Map<const Eigen::VectorXd> signal(values[c]->data(), values[c]->size());
            noise_.push_back(estimateNoiseFromSignal(signal));
            spectra_.push_back(transformSegments(differs ? differTwice(*values[c], interval_) : *values[c], length_));
            share_.push_back(1);
            double power = 0;
            for (std::size_t s = 0; s < spectra_.back().size(); ++s)
                for (std::size_t bin = kFirstUsed; bin < spectra_.back()[s].size(); ++bin) power += netPower(c, s, bin);
            share_.back() = power > 0 ? 1 / power : 0;
        }
    }

    std::vector<Cell> makeCells() const {
        struct Place {
            std::size_t segment, from, to;
            double power;
        };
        std::vector<Place> places;
        double strongest = 0;
        for (std::size_t s = 0; s < spectra_.front().size(); ++s) {
            std::vector<Place> bands;
            double sum = 0;
            const std::size_t bins = length_ / 2;
            const auto end = static_cast<std::size_t>(kHighestUsed * static_cast<double>(bins));
            for (std::size_t from = kFirstUsed; from < end;) {
                const std::size_t width =
                    std::max(kFewestBins, static_cast<std::size_t>(kBandWidth * static_cast<double>(from)));
                bands.push_back({s, from, from + width, 0});
                for (std::size_t bin = from; bin < from + width; ++bin) bands.back().power += relativePower(s, bin);
                sum += bands.back().power;
                from += width;
            }
            for (const Place& band : bands)
                if (band.power > kLeastCellShare * sum) places.push_back(band);
        }
        for (const Place& place : places) strongest = std::max(strongest, place.power);
        places.erase(std::remove_if(places.begin(), places.end(),
                                    [&](const Place& place) { return !(place.power > kLeastPower * strongest); }),
                     places.end());
        // Of too many an even choice over frequency, so that no resonance speaks for all.
        std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.from < b.from; });
        const std::size_t stride = places.size() / kMostCells + 1;
        std::vector<Cell> cells;
        for (std::size_t i = 0; i < places.size(); i += stride)
            cells.push_back(makeCell(places[i].segment, places[i].from, places[i].to));
        return cells;
    }

private:
    double omegaOf(std::size_t bin) const {
        return kTwoPi * static_cast<double>(bin) / (static_cast<double>(length_) * interval_);
    }

    /// What noise of the channel gives to a bin, as an acceleration.
    double noisePower(std::size_t channel, double omega) const {
        const bool differs = channels_[channel].derivative == Derivative::displacement;
        const double rms = (differs ? omega * omega : 1.0) * noise_[channel];
        return rms * rms * kHannPower * static_cast<double>(length_);
    }

    double netPower(std::size_t channel, std::size_t segment, std::size_t bin) const {
        const double floor = kAboveNoise * noisePower(channel, omegaOf(bin));
        return std::max(0.0, std::norm(spectra_[channel][segment][bin]) - floor);
    }

    double relativePower(std::size_t segment, std::size_t bin) const {
        double power = 0;
        for (std::size_t c = 0; c < spectra_.size(); ++c) power += share_[c] * netPower(c, segment, bin);
        return power;
    }

    Cell makeCell(std::size_t segment, std::size_t from, std::size_t to) const {
        const Eigen::Index n = spectra_.size();
        Cell cell;
        const double middle = 0.5 * static_cast<double>(spectra_.front().size() - 1);
        cell.time = (static_cast<double>(segment) - middle) * 0.5 * static_cast<double>(length_) * interval_;
        cell.S = Eigen::MatrixXcd::Zero(n, n);
        cell.noise = Eigen::VectorXd::Zero(n);
        double power = 0;
        for (std::size_t bin = from; bin < to; ++bin) {
            const double omega = omegaOf(bin), difference = correctDifference(omega, interval_);
            Eigen::VectorXcd X(n);
            for (Eigen::Index c = 0; c < n; ++c) {
                const std::size_t i = c;
                const bool differs = channels_[i].derivative == Derivative::displacement;
                X[c] = (differs ? difference : 1.0) * spectra_[i][segment][bin];
                cell.noise[c] += noisePower(i, omega);
            }
            cell.S += X * X.adjoint();
            const double weight = relativePower(segment, bin);
            cell.omega += weight * omega;
            power += weight;
        }
        cell.omega /= power;
        return cell;
    }

    double interval_;
    std::size_t length_ = kLeastLength;
    const std::vector<CellChannel>& channels_;
    std::vector<Spectra> spectra_;
    std::vector<double> noise_, share_;  // RMS; one over the power of the whole channel
};

}  // namespace

PartCells collectCells(const Recording& recording, const MountModel& model, Part part) {
    PartCells result;
    result.interval = recording.sampleInterval();
    std::vector<const std::vector<double>*> values;
    for (const Derivative derivative : {Derivative::displacement, Derivative::acceleration}) {
        const ChannelSet set = collectChannels(recording, model, part, derivative);
        const Eigen::MatrixXd design = makeDesign(set.channels, Eigen::Vector3d::Zero(), kArm);
        for (std::size_t i = 0; i < set.channels.size(); ++i) {
            const MarkerChannel& marker = set.channels[i];
            result.channels.push_back(
                {marker.name, marker.name.substr(0, marker.name.rfind('.')), derivative, marker.axis, design.row(i)});
            values.push_back(&recording.find(marker.name)->values);
        }
    }
    if (part == Part::fixed && model.bracket.empty()) addBase(recording, result.channels, values);
    if (result.channels.empty() || recording.sampleCount() < 4 * kLeastLength) return result;
    Eigen::MatrixXd design(result.channels.size(), 6);
    for (std::size_t c = 0; c < result.channels.size(); ++c) design.row(c) = result.channels[c].row;
    constexpr double kDetermined = 1e-6;  // of the largest singular value
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(design);
    qr.setThreshold(kDetermined);
    result.redundancy = static_cast<int>(design.rows() - qr.rank());
    result.cells = CellMaker(recording, result.channels, values).makeCells();
    return result;
}

}  // namespace wems::identify
