#include "identify/motion/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wems::identify {
namespace {

/// δ⁶ of white noise is √924 times as large.
const double sixth_difference_gain = std::sqrt(924.0);

double sixthDifference(const double* a) {
    return a[-3] + a[3] - 6 * (a[-2] + a[2]) + 15 * (a[-1] + a[1]) - 20 * a[0];
}

/// Mean of the acceleration under the hat of width ±h around sample k, as far as the samples reach.
double hatMean(const double* a, Eigen::Index reach) {
    const double second = a[-1] - 2 * a[0] + a[1];
    double mean = a[0] + second / 12;
    if (reach >= 2) mean -= (a[-2] + a[2] - 4 * (a[-1] + a[1]) + 6 * a[0]) / 240;
    if (reach >= 3) mean += 31.0 / 60480 * sixthDifference(a);
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

/// Solves (I + Dᵀ diag(w) D) x = r in place, D the rows (1, −2, 1) centred on samples 1 … n−2.
void solvePentadiagonal(const std::vector<double>& w, Eigen::VectorXd& r) {
    const Eigen::Index n = r.size();
    const auto weight = [&](Eigen::Index k) { return k >= 1 && k <= n - 2 ? w[k] : 0.0; };
    // LDLᵀ with two subdiagonals l1, l2.
    std::vector<double> d(n), l1(d.size()), l2(d.size());
    double d1 = 1, d2 = 1, below1 = 0;  // d of the two rows before; l1 of the row before
    for (Eigen::Index k = 0; k < n; ++k) {
        const std::size_t i = k;
        const double diagonal = 1 + weight(k - 1) + 4 * weight(k) + weight(k + 1);
        const double first = -2 * (weight(k - 1) + weight(k));
        const double second = weight(k - 1);
        l2[i] = k >= 2 ? second / d2 : 0;
        l1[i] = k >= 1 ? (first - l2[i] * d2 * below1) / d1 : 0;
        d[i] = diagonal - l1[i] * l1[i] * d1 - l2[i] * l2[i] * d2;
        if (k >= 1) r[k] -= l1[i] * r[k - 1];
        if (k >= 2) r[k] -= l2[i] * r[k - 2];
        below1 = l1[i];
        d2 = d1;
        d1 = d[i];
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
        r[k] /= d[k];
        if (k + 1 < n) r[k] -= l1[k + 1] * r[k + 1];
        if (k + 2 < n) r[k] -= l2[k + 2] * r[k + 2];
    }
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
    std::vector<double> weights(n, 0.0);
    for (Eigen::Index k = 1; k < n - 1; ++k) {
        const Eigen::Index reach = std::min(k, n - 1 - k);
        const double* a = a_measured.data() + k;
        const double kink = edges == ContactEdges::sampled ? kinkVariance(a, reach, sigma_a) : 0.0;
        const double variance = sigma_a * sigma_a + kink;
        const double weight = sigma_x * sigma_x / (variance * h * h * h * h);
        weights[k] = weight;
        const double target = weight * h * h * hatMean(a, reach);
        fused.x[k - 1] += target;
        fused.x[k] -= 2 * target;
        fused.x[k + 1] += target;
    }
    solvePentadiagonal(weights, fused.x);
    fused.v = calcVelocity(fused.x, a_measured, h);
    return fused;
}

}  // namespace wems::identify
