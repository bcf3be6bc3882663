#include "identify/inspect/order_tracking.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "models/pi.hpp"

namespace wems::identify {
namespace {

constexpr double window_periods = 5;
constexpr int unknowns = 1 + 2 * tracked_orders;

/// Phase of the drive at each sample, trapezoidal; NaN frequencies continue the one before.
std::vector<double> integratePhase(const std::vector<double>& time, const Eigen::VectorXd& hertz) {
    std::vector<double> phase(time.size(), 0.0);
    for (std::size_t k = 1; k < time.size(); ++k) {
        const Eigen::Index i = k;
        const double f = 0.5 * (hertz[i] + hertz[i - 1]);
        phase[k] = phase[k - 1] + (std::isfinite(f) ? kTwoPi * f * (time[k] - time[k - 1]) : 0.0);
    }
    return phase;
}

/// Samples at which the swept frequency passes through `points` values evenly spaced in its logarithm.
std::vector<std::size_t> choosePoints(const SweptFrequency& swept, int points) {
    std::vector<std::size_t> samples;
    const bool sweeps = swept.highest > 1.05 * swept.lowest;
    const Eigen::Index n = swept.hertz.size();
    double last = std::numeric_limits<double>::quiet_NaN();
    const double step = sweeps ? std::log(swept.highest / swept.lowest) / points : 0;
    for (Eigen::Index k = 0; k < n; ++k) {
        if (!std::isfinite(swept.hertz[k])) continue;
        const double x = sweeps ? std::log(swept.hertz[k]) : static_cast<double>(k);
        const double distance = sweeps ? step : static_cast<double>(n) / points;
        if (std::isfinite(last) && std::abs(x - last) < distance) continue;
        last = x;
        samples.push_back(k);
    }
    return samples;
}

/// Group of channels that `source` of a swept frequency names.
bool isOfSource(const ChannelName& name, const std::string& source) {
    switch (name.part) {
        case Part::load:
            return source == "load";
        case Part::base:
            return source == "base";
        case Part::fixed:
            return source == "fixed part";
        case Part::mobile:
            return source == "mobile part";
        default:
            return false;
    }
}

const Channel* findReference(const Recording& recording, const SweptFrequency& swept) {
    const Channel* best = nullptr;
    double largest = 0;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || !isOfSource(*name, swept.source)) continue;
        const Eigen::Map<const Eigen::VectorXd> values(channel.values.data(), channel.values.size());
        const double power = (values.array() - values.mean()).square().sum();
        if (power > largest) {
            largest = power;
            best = &channel;
        }
    }
    return best;
}

}  // namespace

OrderTracking trackOrders(const Recording& recording, const SweptFrequency& swept, int points) {
    OrderTracking result;
    if (!swept.is_sine) return result;
    const auto samples = choosePoints(swept, points);
    const auto phase = integratePhase(recording.time, swept.hertz);
    const Eigen::Index count = samples.size();
    for (const std::size_t k : samples) {
        result.time.push_back(recording.time[k]);
        result.hertz.push_back(swept.hertz[k]);
    }
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    for (const Channel& channel : recording.channels)
        result.tracks.push_back({channel.name, Eigen::MatrixXd::Constant(tracked_orders, count, nothing),
                                 Eigen::MatrixXd::Constant(tracked_orders, count, nothing)});
    const double interval = recording.sampleInterval();
    for (Eigen::Index p = 0; p < count; ++p) {
        const std::size_t k = samples[p];
        const auto half = static_cast<std::size_t>(0.5 * window_periods / (result.hertz[p] * interval));
        if (half < static_cast<std::size_t>(unknowns) || k < half || k + half >= recording.time.size()) continue;
        const Eigen::Index rows = 2 * half + 1;
        Eigen::MatrixXd design(rows, unknowns);
        for (Eigen::Index i = 0; i < rows; ++i) {
            const double angle = phase[k - half + static_cast<std::size_t>(i)];
            design(i, 0) = 1;
            for (int order = 1; order <= tracked_orders; ++order) {
                design(i, 2 * order - 1) = std::cos(order * angle);
                design(i, 2 * order) = std::sin(order * angle);
            }
        }
        const Eigen::LDLT<Eigen::MatrixXd> solver(design.transpose() * design);
        for (std::size_t c = 0; c < recording.channels.size(); ++c) {
            const Eigen::Map<const Eigen::VectorXd> values(recording.channels[c].values.data() + (k - half), rows);
            const Eigen::VectorXd x = solver.solve(design.transpose() * values);
            for (int order = 1; order <= tracked_orders; ++order) {
                const double a = x[2 * order - 1], b = x[2 * order];
                result.tracks[c].amplitude(order - 1, p) = std::hypot(a, b);
                result.tracks[c].phase(order - 1, p) = std::atan2(-b, a);  // of cos(φ + phase)
            }
        }
    }
    const Channel* reference = findReference(recording, swept);
    if (reference == nullptr) return result;
    result.reference = reference->name;
    const std::size_t index = reference - recording.channels.data();
    const Eigen::RowVectorXd zero = result.tracks[index].phase.row(0);
    for (OrderTrack& track : result.tracks) {
        for (int order = 1; order <= tracked_orders; ++order) {
            for (Eigen::Index p = 0; p < count; ++p)
                track.phase(order - 1, p) = std::remainder(track.phase(order - 1, p) - order * zero[p], kTwoPi);
        }
    }
    return result;
}

}  // namespace wems::identify
