#include "identify/inspect/channel_cells.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/inspect/segment_spectra.hpp"
#include "identify/motion/channel_set.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "models/pi.hpp"

namespace wems::identify {
namespace {

constexpr double kArm = 0.1;                 // m: angular accelerations times this compare with translations
constexpr std::size_t kSegmentsWanted = 24;  // enough to see a clock drift
constexpr std::size_t kLeastLength = 128;    // samples of a segment
constexpr std::size_t kFewestBins = 3;       // the width of a Hann line
constexpr double kBandWidth = 0.15;          // of its frequency
constexpr std::size_t kFirstUsed = 4;        // the window's own spectrum spoils the bins below
constexpr double kLeastCellShare = 0.05;     // of the power of its segment
constexpr double kLeastPower = 1e-3;         // of the strongest cell
constexpr double kAboveNoise = 4;            // power over that of the noise, for a bin to tell of motion
constexpr double kHighestUsed = 0.5;         // of half the sampling rate: filters before sampling differ above
constexpr std::size_t kMostCells = 48;
constexpr double kHannPower = 3.0 / 8;  // mean square of the window

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
            const Eigen::Map<const Eigen::VectorXd> signal(values[c]->data(),
                                                           static_cast<Eigen::Index>(values[c]->size()));
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
        const auto n = static_cast<Eigen::Index>(spectra_.size());
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
                const auto i = static_cast<std::size_t>(c);
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
            result.channels.push_back({marker.name, marker.name.substr(0, marker.name.rfind('.')), derivative,
                                       marker.axis, design.row(static_cast<Eigen::Index>(i))});
            values.push_back(&recording.find(marker.name)->values);
        }
    }
    if (part == Part::fixed && model.bracket.empty()) addBase(recording, result.channels, values);
    if (result.channels.empty() || recording.sampleCount() < 4 * kLeastLength) return result;
    Eigen::MatrixXd design(static_cast<Eigen::Index>(result.channels.size()), 6);
    for (std::size_t c = 0; c < result.channels.size(); ++c)
        design.row(static_cast<Eigen::Index>(c)) = result.channels[c].row;
    constexpr double kDetermined = 1e-6;  // of the largest singular value
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(design);
    qr.setThreshold(kDetermined);
    result.redundancy = static_cast<int>(design.rows() - qr.rank());
    result.cells = CellMaker(recording, result.channels, values).makeCells();
    return result;
}

}  // namespace wems::identify
