#include "identify/motion/channel_suspects.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/motion/differentiation.hpp"
#include "identify/motion/rigid_fit.hpp"

namespace wems::identify {

namespace {

constexpr double kVisible = 5e-4;  // standard error of a gain, beyond which noise hides what calibration scatters by
// Of the largest information: gains of channels that move less than a hundredth of the others are not told from what
// the rigid fit leaves of the large motions.
constexpr double kLeastInformation = 1e-4;
constexpr double kSignificant = 30;  // of the mean square of visible gains over that of noise

}  // namespace

Calibration estimateCalibration(const ChannelSet& set, const Eigen::MatrixXd& residuals, double noise) {
    Calibration calibration;
    for (const MarkerChannel& channel : set.channels) calibration.channels.push_back(channel.name);
    calibration.design = makeDesign(set.channels, Eigen::Vector3d::Zero(), 1.0);
    const bool weighted = std::any_of(set.channels.begin(), set.channels.end(),
                                      [](const MarkerChannel& channel) { return channel.weight != 1; });
    if (set.count() <= 6 || weighted || !std::isfinite(noise)) return calibration;
    const Eigen::MatrixXd pseudo_inverse = calibration.design.completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::MatrixXd left =
        Eigen::MatrixXd::Identity(set.count(), set.count()) - calibration.design * pseudo_inverse;
    const Eigen::VectorXd mean = set.values.rowwise().mean();
    const Eigen::MatrixXd signals = set.values.colwise() - mean;
    const Eigen::MatrixXd normal = left.cwiseProduct(signals * signals.transpose());
    const Eigen::VectorXd right = signals.cwiseProduct(residuals).rowwise().sum();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normal);
    const double least = kLeastInformation * solver.eigenvalues().maxCoeff();
    double squares = 0, from_noise = 0;
    int visible = 0;
    for (Eigen::Index k = 0; k < right.size(); ++k) {
        const double information = solver.eigenvalues()(k);
        if (!(information > least) || noise > kVisible * std::sqrt(information)) continue;
        squares += std::pow(solver.eigenvectors().col(k).dot(right) / information, 2);
        from_noise += noise * noise / information;
        ++visible;
    }
    if (visible > 0 && squares > kSignificant * from_noise)
        calibration.gain_scatter = std::sqrt((squares - from_noise) / visible);
    return calibration;
}

namespace {

constexpr double least_explained = 0.5;    // of the excess over noise
constexpr double least_deviations = 6;     // standard errors
constexpr double least_change = 0.005;     // of the channel's signal
constexpr double same_explained = 0.98;    // of the best: not to be told apart
constexpr double least_redundancy = 0.02;  // 1 − h_cc below this: the others say nothing about this channel
constexpr int most_suspects = 4;

struct SuspectHypothesis {
    ChannelSuspect suspect;
    int channel = 0, other = -1;
    double reduction = 0;  // of Σ|e|²
    bool significant = false;
};

class SuspectSearch {
public:
    SuspectSearch(const std::vector<MarkerChannel>& channels, Eigen::MatrixXd signals, double noise, double interval)
        : channels_(channels), signals_(std::move(signals)), noise_(noise), interval_(interval) {
        const Eigen::MatrixXd J = makeDesign(channels, Eigen::Vector3d::Zero(), 1.0);
        residual_maker_ =
            Eigen::MatrixXd::Identity(J.rows(), J.rows()) - J * J.completeOrthogonalDecomposition().pseudoInverse();
    }

    std::vector<ChannelSuspect> search() {
        std::vector<ChannelSuspect> suspects;
        const auto freedoms = static_cast<double>((channels_.size() - 6) * static_cast<std::size_t>(signals_.cols()));
        for (int round = 0; round < most_suspects; ++round) {
            const Eigen::MatrixXd moments = signals_ * signals_.transpose();
            const double total = (residual_maker_ * moments).trace();
            const double excess = total - noise_ * noise_ * freedoms;
            if (excess < least_deviations * noise_ * noise_ * std::sqrt(2 * freedoms)) break;
            std::vector<SuspectHypothesis> hypotheses = collectHypotheses(moments, total);
            const auto best = std::max_element(hypotheses.begin(), hypotheses.end(),
                                               [](const auto& a, const auto& b) { return a.reduction < b.reduction; });
            if (best == hypotheses.end() || best->reduction < least_explained * excess) break;
            best->suspect.explained = std::min(1.0, best->reduction / excess);
            for (const SuspectHypothesis& rival : hypotheses) {
                if (rival.channel != best->channel && rival.other < 0 &&
                    rival.reduction > same_explained * best->reduction)
                    best->suspect.alternatives.push_back(rival.suspect.channel);
            }
            correct(*best);
            suspects.push_back(best->suspect);
        }
        return suspects;
    }

private:
    /// Those that pass the limits on significance and size.
    std::vector<SuspectHypothesis> collectHypotheses(const Eigen::MatrixXd& moments, double total) const {
        std::vector<SuspectHypothesis> hypotheses;
        const int m = static_cast<int>(channels_.size());
        for (int c = 0; c < m; ++c) {
            if (residual_maker_(c, c) < least_redundancy) continue;
            for (const SuspectHypothesis& hypothesis : {makeGain(c), makeDelay(c)}) {
                if (hypothesis.significant) hypotheses.push_back(hypothesis);
            }
            for (int other = c + 1; other < m; ++other) {
                SuspectHypothesis exchange;
                exchange.channel = c;
                exchange.other = other;
                exchange.suspect = named(c, "exchanged");
                exchange.suspect.exchanged_with = channels_[other].name;
                Eigen::PermutationMatrix<Eigen::Dynamic> swap(m);
                swap.setIdentity();
                swap.applyTranspositionOnTheRight(c, other);
                const Eigen::MatrixXd swapped = swap * moments * swap.transpose();
                // Handicapped a little: where two motions are nearly equal a gain is the simpler tale.
                exchange.reduction = 0.99 * (total - (residual_maker_ * swapped).trace());
                if (exchange.reduction > 0) hypotheses.push_back(exchange);
            }
        }
        return hypotheses;
    }

    ChannelSuspect named(int c, const char* fault) const {
        ChannelSuspect suspect;
        suspect.channel = channels_[c].name;
        suspect.fault = fault;
        return suspect;
    }

    /// What the other channels say about channel c, and how far it is from that.
    std::pair<Eigen::VectorXd, Eigen::VectorXd> predict(int c) const {
        Eigen::VectorXd difference = (residual_maker_.row(c) * signals_).transpose() / residual_maker_(c, c);
        Eigen::VectorXd prediction = signals_.row(c).transpose() - difference;
        return {std::move(prediction), std::move(difference)};
    }

    SuspectHypothesis makeGain(int c) const {
        const double redundancy = residual_maker_(c, c);
        const auto [prediction, difference] = predict(c);
        const auto n = static_cast<double>(prediction.size());
        const double prediction_variance = noise_ * noise_ * (1 - redundancy) / redundancy;
        const double power = prediction.squaredNorm() - n * prediction_variance;
        const double change = prediction.dot(difference) + n * prediction_variance;
        SuspectHypothesis hypothesis;
        hypothesis.channel = c;
        hypothesis.suspect = named(c, "gain");
        if (!(power > n * prediction_variance)) return hypothesis;
        hypothesis.suspect.gain = 1 + change / power;
        hypothesis.suspect.standard_error = noise_ / std::sqrt(redundancy * power);
        hypothesis.reduction = change * change / power * redundancy;
        hypothesis.significant = passes(change / power, hypothesis.suspect.standard_error, 1);
        return hypothesis;
    }

    SuspectHypothesis makeDelay(int c) const {
        const double redundancy = residual_maker_(c, c);
        const auto [prediction, difference] = predict(c);
        const double cutoff = findCutoff(prediction.transpose(), interval_);
        const Eigen::VectorXd rate = differentiate(smoothZeroPhase(prediction, interval_, cutoff), interval_).first;
        const double power = rate.squaredNorm();
        SuspectHypothesis hypothesis;
        hypothesis.channel = c;
        hypothesis.suspect = named(c, "delay");
        if (!(power > 0)) return hypothesis;
        const double delay = -rate.dot(difference) / power;
        hypothesis.suspect.delay = delay;
        hypothesis.suspect.standard_error = noise_ / std::sqrt(redundancy * power);
        hypothesis.reduction = delay * delay * power * redundancy;
        hypothesis.significant =
            passes(delay, hypothesis.suspect.standard_error, std::sqrt(power / prediction.squaredNorm()));
        return hypothesis;
    }

    /// @param scale relative change of the channel for a unit change of the parameter
    static bool passes(double change, double standard_error, double scale) {
        return std::abs(change) > least_deviations * standard_error && std::abs(change) * scale > least_change;
    }

    void correct(const SuspectHypothesis& best) {
        if (best.other >= 0) {
            signals_.row(best.channel).swap(signals_.row(best.other));
        } else {
            // What the others say takes its place: nothing of the fault is left, whatever its kind.
            signals_.row(best.channel) = predict(best.channel).first.transpose();
        }
    }

    const std::vector<MarkerChannel>& channels_;
    Eigen::MatrixXd signals_, residual_maker_;
    double noise_, interval_;
};

}  // namespace

std::vector<ChannelSuspect> findSuspects(const std::vector<MarkerChannel>& channels, const Eigen::MatrixXd& fitted,
                                         const Eigen::MatrixXd& residuals, double noise, double interval) {
    if (channels.size() <= 6 || !(noise >= 0)) return {};
    return SuspectSearch(channels, fitted + residuals, noise, interval).search();
}

}  // namespace wems::identify
