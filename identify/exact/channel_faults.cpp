#include "identify/exact/channel_faults.hpp"

#include <Eigen/Core>
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "identify/motion/motion.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/problem/fourier.hpp"
#include "models/bryant.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {

namespace {

/// Values at times later by `delay` (s).
std::vector<double> advance(const std::vector<double>& values, double delay, double interval) {
    const auto count = static_cast<long>(values.size());
    const auto at = [&](long k) { return values[std::clamp(k, 0L, count - 1)]; };
    std::vector<double> result(values.size());
    for (long k = 0; k < count; ++k) {
        const double position = static_cast<double>(k) + delay / interval;
        const auto i = static_cast<long>(std::floor(position));
        const double u = position - static_cast<double>(i);
        const double a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
        // Lagrange's cubic through four neighbours.
        result[k] = -a * u * (u - 1) * (u - 2) / 6 + b * (u + 1) * (u - 1) * (u - 2) / 2 -
                    c * (u + 1) * u * (u - 2) / 2 + d * (u + 1) * u * (u - 1) / 6;
    }
    return result;
}

/// @param displacements whether the recording has any
bool applies(const SensorFault& fault, const std::string& channel, bool displacements) {
    if (channel == fault.channel) return true;
    const auto name = parseChannelName(channel);
    if (!name) return false;
    const std::string side = name->part == Part::mobile ? "mobile" : name->part == Part::fixed ? "fixed" : "";
    if (side.empty()) return false;
    const std::string triad = side + "." + name->connection;
    if (name->derivative == Derivative::displacement) return fault.channel == side || fault.channel == triad;
    return name->derivative == Derivative::acceleration &&
           (fault.channel == triad + ".a" || (fault.channel == side && !displacements));
}

bool hasDisplacements(const Recording& recording) {
    return std::any_of(recording.channels.begin(), recording.channels.end(), [](const Channel& channel) {
        const auto name = parseChannelName(channel.name);
        return name && (name->part == Part::mobile || name->part == Part::fixed) &&
               name->derivative == Derivative::displacement;
    });
}

void rotateBack(Recording& recording, const SensorFault& fault, bool displacements) {
    const Eigen::Matrix3d R = rotationFromVector(fault.rotation).transpose();
    for (const char* side : {"mobile", "fixed"})
        for (const auto& connection : recording.connections(std::string(side) == "mobile" ? Part::mobile : Part::fixed))
            for (const char* prefix : {"", "a"}) {
                Channel* axis[3] = {nullptr, nullptr, nullptr};
                for (auto& channel : recording.channels)
                    for (int a = 0; a < 3; ++a)
                        if (channel.name == std::string(side) + "." + connection + "." + prefix + kAxes[a] &&
                            applies(fault, channel.name, displacements))
                            axis[a] = &channel;
                if (!axis[0] || !axis[1] || !axis[2]) continue;
                for (std::size_t k = 0; k < axis[0]->values.size(); ++k) {
                    const Eigen::Vector3d v =
                        R * Eigen::Vector3d(axis[0]->values[k], axis[1]->values[k], axis[2]->values[k]);
                    for (int a = 0; a < 3; ++a) axis[a]->values[k] = v[a];
                }
            }
}

}  // namespace

Recording correctChannels(const Recording& recording, const std::vector<SensorFault>& faults) {
    Recording result = recording;
    const double interval = recording.sampleInterval();
    const bool displacements = hasDisplacements(recording);
    for (const auto& fault : faults) {
        for (auto& channel : result.channels) {
            if (!applies(fault, channel.name, displacements)) continue;
            if (fault.gain != 1)
                for (double& value : channel.values) value /= fault.gain;
            if (fault.delay != 0) channel.values = advance(channel.values, fault.delay, interval);
        }
        if (!fault.rotation.isZero(0.0)) rotateBack(result, fault, displacements);
    }
    return result;
}

namespace {

constexpr int kMostFaults = 4;
constexpr double kLeastShare = 0.25;                                                // of what exceeds the noise
constexpr double kChannelPass = 110.0, kChannelStop = 200.0, kChannelRate = 500.0;  // Hz

/// Sums over all samples of all recordings: z = (s, s') of the m channels.
struct Moments {
    Eigen::MatrixXd signal;   // Σ z zᵀ, 2m x 2m
    Eigen::MatrixXd misfit;   // Σ e zᵀ, m x 2m
    Eigen::MatrixXd project;  // P, m x m
    double square = 0;        // Σ |e|²
    double variance = 0;      // of e per decimated sample, from white noise
    double count = 0;         // independent values in e
    std::vector<MarkerChannel> channels;
};

Moments calcMoments(const std::vector<Recording>& recordings, const MountModel& model, Part part) {
    Moments result;
    double noise_square = 0, noise_count = 0, step_interval = 0, raw_interval = 0;
    for (const auto& recording : recordings) {
        ChannelSet set = collectChannels(recording, model, part, Derivative::displacement);
        const bool accelerations = set.empty();
        if (accelerations) set = collectChannels(recording, model, part, Derivative::acceleration);
        if (set.count() < 7) return {};
        const RigidFit fit(set, BodyMotion{});
        if (!fit.undetermined().empty()) return {};
        Eigen::Matrix3Xd p, theta;
        Eigen::MatrixXd residuals;
        if (accelerations) {
            // The centripetal terms are of second order: the angular velocity may come from faulty channels.
            const RunMotion motion = estimateMotion(recording, model);
            const PartMotion& own = part == Part::mobile ? motion.mobile : motion.fixed;
            if (own.theta.cols() != set.values.cols()) return {};
            fit.solveAccelerations(own.theta, own.w, p, theta, &residuals);
        } else {
            fit.solvePoses(p, theta, &residuals);
        }
        const Eigen::MatrixXd rigid = set.values - residuals;
        raw_interval = recording.sampleInterval();
        const double nyquist = 0.5 / raw_interval, stop = std::min(kChannelStop, 0.95 * nyquist);
        const SmoothingKernel kernel(raw_interval, std::min(kChannelPass, 0.55 * stop), stop);
        const int step = std::max(1, static_cast<int>(1 / raw_interval / kChannelRate));
        step_interval = raw_interval * step;
        const Eigen::MatrixXd e = kernel.apply(residuals, 0, step);
        Eigen::MatrixXd z(2 * set.count(), e.cols());
        z << kernel.apply(rigid, 0, step), kernel.apply(rigid, 1, step);
        if (result.channels.empty()) {
            result.channels = set.channels;
            result.signal = Eigen::MatrixXd::Zero(z.rows(), z.rows());
            result.misfit = Eigen::MatrixXd::Zero(set.count(), z.rows());
            Eigen::MatrixXd J(set.count(), 6);
            for (int c = 0; c < set.count(); ++c) {
                const auto& channel = set.channels[c];
                const Eigen::Vector3d& axis = channel.direction;
                J.row(c) << axis.transpose(), channel.position.cross(axis).transpose();
            }
            result.project = Eigen::MatrixXd::Identity(set.count(), set.count()) -
                             J * (J.transpose() * J).ldlt().solve(J.transpose());
        }
        if (set.count() != static_cast<int>(result.channels.size())) return {};
        result.signal += z * z.transpose();
        result.misfit += e * z.transpose();
        result.square += e.squaredNorm();
        result.count += static_cast<double>(e.cols());
        // Noise from neighbours: what a smooth signal cannot contain.
        const Eigen::MatrixXd third =
            residuals.rightCols(residuals.cols() - 3) - 3 * residuals.middleCols(2, residuals.cols() - 3) +
            3 * residuals.middleCols(1, residuals.cols() - 3) - residuals.leftCols(residuals.cols() - 3);
        noise_square += third.squaredNorm() / 20;
        noise_count += static_cast<double>(third.cols()) * static_cast<double>(set.count() - 6);
    }
    const double variance = std::max(noise_square / noise_count, 1e-18);
    result.variance = variance * raw_interval / step_interval;
    return result;
}

struct ChannelHypothesis {
    std::string cause, channel;
    std::vector<Eigen::MatrixXd> maps;  // m x 2m: perturbation of the channels = map · z for a unit of each number
};

/// `mobile.1`, or `mobile.1.a` of an accelerometer.
std::string triadOf(const MarkerChannel& channel) {
    const auto dot = channel.name.rfind('.');
    return channel.name.substr(0, dot + 2 < channel.name.size() ? dot + 2 : dot);
}

std::vector<ChannelHypothesis> listHypotheses(const std::vector<MarkerChannel>& channels) {
    const Eigen::Index m = channels.size();
    std::vector<ChannelHypothesis> list;
    for (Eigen::Index c = 0; c < m; ++c) {
        const auto& channel = channels[c];
        Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(m, 2 * m), delay = gain;
        gain(c, c) = 1;
        delay(c, m + c) = -1;
        list.push_back({"sensor_gain", channel.name, {gain}});
        list.push_back({"sensor_delay", channel.name, {delay}});
        if (channel.axis != 0 || c + 2 >= m || channels[c + 2].axis != 2 ||
            triadOf(channels[c + 2]) != triadOf(channel))
            continue;
        ChannelHypothesis turned{"sensor_misalignment", triadOf(channel), {}};
        ChannelHypothesis late{"sensor_delay", triadOf(channel), {Eigen::MatrixXd::Zero(m, 2 * m)}};
        ChannelHypothesis scaled{"sensor_gain", triadOf(channel), {Eigen::MatrixXd::Zero(m, 2 * m)}};
        for (int r = 0; r < 3; ++r) {
            Eigen::MatrixXd map = Eigen::MatrixXd::Zero(m, 2 * m);
            const int next = (r + 1) % 3, last = (r + 2) % 3;  // e_r × s
            map(c + next, c + last) = -1;
            map(c + last, c + next) = 1;
            turned.maps.push_back(map);
            late.maps[0](c + r, m + c + r) = -1;
            scaled.maps[0](c + r, c + r) = 1;
        }
        list.push_back(turned);
        list.push_back(late);
        list.push_back(scaled);
    }
    return list;
}

/// Inner products with the calibration of all channels marginalised, in units of the noise.
class Tester {
public:
    Tester(const Moments& moments, double gain_scatter) : moments_(moments) {
        const Eigen::Index m = moments.channels.size();
        Eigen::MatrixXd normal(m, m);
        for (Eigen::Index c = 0; c < m; ++c) {
            Eigen::MatrixXd map = Eigen::MatrixXd::Zero(m, 2 * m);
            map(c, c) = 1;
            gains_.push_back(map);
        }
        for (Eigen::Index c = 0; c < m; ++c)
            for (Eigen::Index d = 0; d < m; ++d) normal(c, d) = rawProduct(gains_[c], gains_[d]);
        normal.diagonal().array() += moments.variance / (gain_scatter * gain_scatter);
        factor_.compute(normal);
        on_misfit_.resize(m);
        for (Eigen::Index c = 0; c < m; ++c) on_misfit_[c] = rawMisfit(gains_[c]);
        excess_ = (moments.square - on_misfit_.dot(factor_.solve(on_misfit_))) / moments.variance;
    }
    double misfit() const { return excess_; }

    /// Whether a fault of this kind leaves something that no rigid motion does. Of three accelerometers a fault along
    /// the axis of which there are three leaves round-off alone.
    bool shows(const ChannelHypothesis& hypothesis) const {
        constexpr double least = 1e-6;  // of its square: positions say no better where a sensor is
        return std::all_of(hypothesis.maps.begin(), hypothesis.maps.end(), [&](const Eigen::MatrixXd& map) {
            return rawProduct(map, map) > least * (map * moments_.signal).cwiseProduct(map).sum();
        });
    }

    /// Least squares of a hypothesis: gain in misfit, values, standard errors.
    double test(const ChannelHypothesis& hypothesis, Eigen::VectorXd& values, Eigen::VectorXd& errors) const {
        const Eigen::Index count = hypothesis.maps.size();
        Eigen::MatrixXd normal(count, count);
        Eigen::VectorXd right(count);
        std::vector<Eigen::VectorXd> on_gains;
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto& a = hypothesis.maps[i];
            Eigen::VectorXd products(on_misfit_.size());
            for (Eigen::Index c = 0; c < products.size(); ++c) products[c] = rawProduct(a, gains_[c]);
            on_gains.push_back(products);
            right[i] = (rawMisfit(a) - products.dot(factor_.solve(on_misfit_))) / moments_.variance;
            for (Eigen::Index j = 0; j <= i; ++j) {
                const std::size_t s = j;
                normal(i, j) = normal(j, i) =
                    (rawProduct(a, hypothesis.maps[s]) - products.dot(factor_.solve(on_gains[s]))) / moments_.variance;
            }
        }
        normal.diagonal().array() += 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
        if (hypothesis.cause == "sensor_misalignment") normal.diagonal().array() += 1 / (kTurned * kTurned);
        const Eigen::MatrixXd inverse = normal.inverse();
        values = inverse * right;
        errors = inverse.diagonal().cwiseAbs().cwiseSqrt();
        return values.dot(right);
    }

private:
    double rawProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const {
        return (moments_.project * a * moments_.signal).cwiseProduct(b).sum();
    }
    double rawMisfit(const Eigen::MatrixXd& a) const { return a.cwiseProduct(moments_.misfit).sum(); }

    const Moments& moments_;
    std::vector<Eigen::MatrixXd> gains_;
    Eigen::LLT<Eigen::MatrixXd> factor_;
    Eigen::VectorXd on_misfit_;
    double excess_ = 0;
};

bool isFault(const ChannelHypothesis& hypothesis, const Eigen::VectorXd& values, double gain_scatter) {
    if (hypothesis.cause == "sensor_gain") return std::abs(values[0]) > kScatters * gain_scatter;
    if (hypothesis.cause == "sensor_delay") return std::abs(values[0]) > kLeastDelay;
    return isTurned(values);
}

void addTo(ChannelFault& fault, const Eigen::VectorXd& values, const Eigen::VectorXd& errors) {
    if (fault.cause == "sensor_gain") {
        fault.fault.gain *= 1 + values[0];
        fault.gain_error = errors[0] * std::abs(fault.fault.gain);
    } else if (fault.cause == "sensor_delay") {
        fault.fault.delay += values[0];
        fault.delay_error = errors[0];
    } else {
        fault.fault.rotation += values.head<3>();
        fault.rotation_error = errors.maxCoeff();
    }
}

/// Faults of one side; refined by correcting and testing again.
std::vector<ChannelFault> findOnSide(const std::vector<Recording>& recordings, const MountModel& model, Part part,
                                     double gain_scatter) {
    std::vector<ChannelFault> faults;
    const auto corrected = [&] {
        std::vector<SensorFault> list;
        for (const auto& fault : faults) list.push_back(fault.fault);
        std::vector<Recording> result;
        for (const auto& recording : recordings) result.push_back(correctChannels(recording, list));
        return result;
    };
    for (int round = 0; round < kMostFaults; ++round) {
        Moments moments = calcMoments(corrected(), model, part);
        if (moments.channels.empty()) return faults;
        const auto hypotheses = listHypotheses(moments.channels);
        const Tester tester(moments, gain_scatter);
        const double expected = moments.count * static_cast<double>(moments.channels.size() - 6);
        double best = 0;
        const ChannelHypothesis* chosen = nullptr;
        for (const auto& hypothesis : hypotheses) {
            if (!tester.shows(hypothesis)) continue;
            Eigen::VectorXd values, errors;
            const double gain = tester.test(hypothesis, values, errors) - 30.0 * static_cast<double>(values.size());
            if (gain > best && isFault(hypothesis, values, gain_scatter)) {
                best = gain;
                chosen = &hypothesis;
            }
        }
        // The smoothed noise has less than its white variance, so what exceeds it is underestimated: cautious.
        const double excess = std::max(0.0, tester.misfit() - 0.6 * expected);
        if (chosen == nullptr || best < std::max(kLeastFaultGain, kLeastShare * excess)) return faults;
        ChannelFault fault;
        fault.cause = chosen->cause;
        fault.fault.channel = chosen->channel;
        fault.improvement = tester.misfit();
        faults.push_back(fault);
        for (int pass = 0; pass < 3; ++pass) {
            moments = calcMoments(corrected(), model, part);
            const Tester again(moments, gain_scatter);
            Eigen::VectorXd values, errors;
            again.test(*chosen, values, errors);
            addTo(faults.back(), values, errors);
            if ((values.cwiseAbs().array() < 0.3 * errors.array()).all()) break;
        }
        moments = calcMoments(corrected(), model, part);
        faults.back().improvement /= std::max(Tester(moments, gain_scatter).misfit(), 1.0);
    }
    return faults;
}

}  // namespace

std::vector<ChannelFault> findChannelFaults(const std::vector<Recording>& recordings, const MountModel& model,
                                            double gain_scatter) {
    auto faults = findOnSide(recordings, model, Part::mobile, gain_scatter);
    const auto fixed = findOnSide(recordings, model, Part::fixed, gain_scatter);
    faults.insert(faults.end(), fixed.begin(), fixed.end());
    return faults;
}

}  // namespace wems::identify
