#include "identify/motion/fusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace wems::identify {
namespace {

/// δ⁶ of white noise is √924 times as large.
const double sixth_difference_gain = std::sqrt(924.0);

double sixthDifference(const double* a) {
    return a[-3] + a[3] - 6 * (a[-2] + a[2]) + 15 * (a[-1] + a[1]) - 20 * a[0];
}

/// Of the samples k − 3 … k + 3 in the mean of the acceleration under the hat of width ±h around sample k, as far as
/// the samples reach.
std::array<double, 7> hatWeights(Eigen::Index reach) {
    std::array<double, 7> weights{0, 0, 1.0 / 12, 1 - 2.0 / 12, 1.0 / 12, 0, 0};
    const auto add = [&](double factor, const std::array<double, 4>& difference) {
        for (std::size_t i = 0; i < difference.size(); ++i) {
            weights[3 - i] += factor * difference[i];
            if (i > 0) weights[3 + i] += factor * difference[i];
        }
    };
    if (reach >= 2) add(-1.0 / 240, {6, -4, 1, 0});
    if (reach >= 3) add(31.0 / 60480, {-20, 15, -6, 1});
    return weights;
}

double hatMean(const double* a, Eigen::Index reach) {
    const std::array<double, 7> weights = hatWeights(reach);
    double mean = 0;
    for (Eigen::Index i = -std::min<Eigen::Index>(reach, 3); i <= std::min<Eigen::Index>(reach, 3); ++i)
        mean += weights[static_cast<std::size_t>(3 + i)] * a[i];
    return mean;
}

/// A kink of slope change J (per sample) makes δ⁶ peak at 6 J and the hat mean wrong by at most J/12 or so; what noise
/// makes of δ⁶ is left out.
double kinkVariance(const double* a, Eigen::Index reach, double sigma_a) {
    if (reach < 3) return 0;
    const double sixth = sixthDifference(a);
    const double noise = 3 * sixth_difference_gain * sigma_a;
    return std::max(0.0, sixth * sixth - noise * noise) / (36.0 * 36.0);
}

Eigen::VectorXd calcVelocity(const Eigen::VectorXd& x, const Eigen::VectorXd& a, double h) {
    const Eigen::Index n = x.size();
    Eigen::VectorXd v(n);
    v[0] = (x[1] - x[0]) / h - h * (2 * a[0] + a[1]) / 6;
    v[n - 1] = (x[n - 1] - x[n - 2]) / h + h * (2 * a[n - 1] + a[n - 2]) / 6;
    for (Eigen::Index k = 1; k < n - 1; ++k) {
        const Eigen::Index reach = std::min(k, n - 1 - k);
        double correction = (a[k + 1] - a[k - 1]) / 12;
        if (reach >= 2) correction -= 7.0 / 720 * (a[k + 2] - 2 * a[k + 1] + 2 * a[k - 1] - a[k - 2]);
        if (reach >= 3)
            correction +=
                37.0 / 20160 * (a[k + 3] - 4 * a[k + 2] + 5 * a[k + 1] - 5 * a[k - 1] + 4 * a[k - 2] - a[k - 3]);
        v[k] = (x[k + 1] - x[k - 1]) / (2 * h) - h * correction;
    }
    return v;
}

}  // namespace

FusedSignal fuseDisplacementAndAcceleration(const Eigen::VectorXd& x_measured, double sigma_x,
                                            const Eigen::VectorXd& a_measured, double sigma_a, double h,
                                            ContactEdges edges) {
    const Eigen::Index n = x_measured.size();
    FusedSignal fused;
    fused.x = x_measured;
    fused.weights = Eigen::VectorXd::Zero(n);
    for (Eigen::Index k = 1; k < n - 1; ++k) {
        const Eigen::Index reach = std::min(k, n - 1 - k);
        const double* a = a_measured.data() + k;
        const double kink = edges == ContactEdges::sampled ? kinkVariance(a, reach, sigma_a) : 0.0;
        const double variance = sigma_a * sigma_a + kink;
        const double weight = sigma_x * sigma_x / (variance * h * h * h * h);
        fused.weights[k] = weight;
        const double target = weight * h * h * hatMean(a, reach);
        fused.x[k - 1] += target;
        fused.x[k] -= 2 * target;
        fused.x[k + 1] += target;
    }
    Pentadiagonal(fused.weights).solve(fused.x);
    fused.v = calcVelocity(fused.x, a_measured, h);
    return fused;
}

Pentadiagonal::Pentadiagonal(const Eigen::Ref<const Eigen::VectorXd>& weights)
    : d_(static_cast<std::size_t>(weights.size())), l1_(d_.size()), l2_(d_.size()) {
    const Eigen::Index n = weights.size();
    const auto weight = [&](Eigen::Index k) { return k >= 1 && k <= n - 2 ? weights[k] : 0.0; };
    double d1 = 1, d2 = 1, below1 = 0;  // d of the two rows before; l1 of the row before
    for (Eigen::Index k = 0; k < n; ++k) {
        const std::size_t i = k;
        const double diagonal = 1 + weight(k - 1) + 4 * weight(k) + weight(k + 1);
        const double first = -2 * (weight(k - 1) + weight(k));
        const double second = weight(k - 1);
        l2_[i] = k >= 2 ? second / d2 : 0;
        l1_[i] = k >= 1 ? (first - l2_[i] * d2 * below1) / d1 : 0;
        d_[i] = diagonal - l1_[i] * l1_[i] * d1 - l2_[i] * l2_[i] * d2;
        below1 = l1_[i];
        d2 = d1;
        d1 = d_[i];
    }
}

void Pentadiagonal::solve(Eigen::VectorXd& r) const {
    const Eigen::Index n = r.size();
    for (Eigen::Index k = 0; k < n; ++k) {
        if (k >= 1) r[k] -= l1_[k] * r[k - 1];
        if (k >= 2) r[k] -= l2_[k] * r[k - 2];
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
        r[k] /= d_[k];
        if (k + 1 < n) r[k] -= l1_[k + 1] * r[k + 1];
        if (k + 2 < n) r[k] -= l2_[k + 2] * r[k + 2];
    }
}

FusionAdjoint::FusionAdjoint(Eigen::VectorXd weights, double h)
    : weights_(std::move(weights)), h_(h), equations_(weights_) {}

Eigen::VectorXd FusionAdjoint::apply(Eigen::VectorXd& influence) const {
    equations_.solve(influence);
    const Eigen::Index n = influence.size();
    Eigen::VectorXd result = Eigen::VectorXd::Zero(n);
    for (Eigen::Index k = 1; k < n - 1; ++k) {
        const Eigen::Index reach = std::min(k, n - 1 - k);
        const double second = influence[k - 1] - 2 * influence[k] + influence[k + 1];
        const std::array<double, 7> hat = hatWeights(reach);
        for (Eigen::Index i = -std::min<Eigen::Index>(reach, 3); i <= std::min<Eigen::Index>(reach, 3); ++i)
            result[k + i] += weights_[k] * h_ * h_ * second * hat[static_cast<std::size_t>(3 + i)];
    }
    return result;
}

}  // namespace wems::identify
