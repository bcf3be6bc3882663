#include "identify/spectra/margins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/fit/law_history.hpp"
#include "identify/forward/relative_displacement.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

namespace {

/// How a curve falls from a peak to one side before it rises above the peak or ends.
struct Flank {
    double fall = 1;                                               // lowest share of the peak
    double half_power = std::numeric_limits<double>::quiet_NaN();  // Hz, where it is 1/√2
};

Flank descend(const Eigen::VectorXd& frequency, const Eigen::VectorXd& amplitude, Eigen::Index peak, int step,
              double height) {
    Flank flank;
    const double half = height / std::sqrt(2.0);
    for (Eigen::Index k = peak + step; k >= 0 && k < amplitude.size(); k += step) {
        const double value = amplitude[k];
        if (!std::isfinite(value) || value > height) break;
        const double before = amplitude[k - step];
        if (std::isnan(flank.half_power) && value <= half) {
            const double share = before > value ? (before - half) / (before - value) : 0;
            flank.half_power = frequency[k - step] + share * (frequency[k] - frequency[k - step]);
        }
        flank.fall = std::min(flank.fall, value / height);
    }
    return flank;
}

}  // namespace

std::vector<ResponsePeak> findPeaks(const Eigen::VectorXd& frequency, const Eigen::VectorXd& amplitude, double from,
                                    double to) {
    const double three_decibels = std::sqrt(0.5), one_decibel = std::pow(10, -1.0 / 20);
    std::vector<ResponsePeak> peaks;
    for (Eigen::Index k = 1; k + 1 < amplitude.size(); ++k) {
        if (!(frequency[k] >= from && frequency[k] <= to)) continue;
        if (!(amplitude[k] > amplitude[k - 1] && amplitude[k] >= amplitude[k + 1] && amplitude[k - 1] > 0 &&
              amplitude[k + 1] > 0))
            continue;
        const double left = std::log(amplitude[k - 1]), middle = std::log(amplitude[k]),
                     right = std::log(amplitude[k + 1]);
        const double place = 0.5 * (left - right) / (left - 2 * middle + right);
        ResponsePeak peak;
        peak.bin = k;
        peak.frequency = frequency[k] + place * (frequency[k + 1] - frequency[k]);
        peak.amplitude = std::exp(middle - 0.25 * (left - right) * place);
        const Flank below = descend(frequency, amplitude, k, -1, peak.amplitude);
        const Flank above = descend(frequency, amplitude, k, 1, peak.amplitude);
        if (std::min(below.fall, above.fall) > three_decibels || std::max(below.fall, above.fall) > one_decibel)
            continue;
        peak.damping_ratio = (above.half_power - below.half_power) / (2 * peak.frequency);
        peaks.push_back(peak);
    }
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const ResponsePeak& a, const ResponsePeak& b) { return a.amplitude > b.amplitude; });
    return peaks;
}

namespace {

template <class Values>
ConnectionMargin measure(const std::string& name, const Values& q) {
    ConnectionMargin margin;
    margin.name = name;
    margin.lowest = q.minCoeff();
    margin.highest = q.maxCoeff();
    margin.rms = std::sqrt((q.array() - q.mean()).square().mean());
    return margin;
}

void findLeft(const AxisLaw& law, double lowest, double highest, ConnectionMargin& margin) {
    for (const Stop& stop : law.stops) {
        const bool positive = stop.side == Side::positive;
        const double left = stop.clearance - (positive ? highest + law.offset : -(lowest + law.offset));
        auto& target = positive ? margin.left_positive : margin.left_negative;
        target = target ? std::fmin(*target, left) : left;
    }
}

}  // namespace

Margins findMargins(const Recording& recording, const MountModel* model) {
    Margins margins;
    try {
        if (model == nullptr) {
            const RelativeDisplacement relative = calcRelativeDisplacement(recording);
            for (std::size_t i = 0; i < relative.names.size(); ++i)
                margins.connections.push_back(measure(relative.names[i], relative.q.row(i)));
            margins.notes = relative.notes;
            return margins;
        }
        const RunMotion motion = estimateMotion(recording, *model);
        const RelativeHistory relative = calcRelativeHistory(motion, *model);
        const RowMatrix force = calcForceHistory(*model, relative, motion.time);
        const Eigen::VectorXd rest = calcRestDisplacement(*model);
        for (std::size_t i = 0; i < model->connections.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const Eigen::Index column = 3 * i + k;
                const Eigen::VectorXd q = relative.q.col(column);
                const std::string name = model->connections[i].name + "." + "xyz"[k];
                ConnectionMargin margin = measure(name, (q.array() - rest[column]).matrix());
                margin.largest_force = force.col(column).cwiseAbs().maxCoeff();
                findLeft(model->connections[i].axis[k], q.minCoeff(), q.maxCoeff(), margin);
                margins.connections.push_back(margin);
            }
        margins.notes = motion.notes;
    } catch (const InputError& error) {
        // Spectra of single channels need no relative motion; what it takes is said.
        margins.connections.clear();
        margins.notes = {std::string("no relative displacements: ") + error.what()};
    }
    return margins;
}

}  // namespace wems::identify
