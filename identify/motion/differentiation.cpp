#include "identify/motion/differentiation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/motion/spectrum.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

/// One pass of a third-order Butterworth low pass (bilinear transform), started at rest at the first sample.
void filterOnce(std::vector<double>& x, double w) {
    // First-order section 1/(1 + s) and second-order section 1/(1 + s + s²), s = (1 − z⁻¹)/(w (1 + z⁻¹)).
    const double b1 = w / (1 + w), a1 = (w - 1) / (w + 1);
    const double norm = 1 + w + w * w;
    const double b2 = w * w / norm, c1 = 2 * (w * w - 1) / norm, c2 = (1 - w + w * w) / norm;
    double x1 = x[0], y1 = x[0], u1 = x[0], u2 = x[0], z1 = x[0], z2 = x[0];
    for (double& value : x) {
        const double y = b1 * (value + x1) - a1 * y1;
        x1 = value;
        y1 = y;
        const double z = b2 * (y + 2 * u1 + u2) - c1 * z1 - c2 * z2;
        u2 = u1;
        u1 = y;
        z2 = z1;
        z1 = z;
        value = z;
    }
}

}  // namespace

Eigen::VectorXd smoothZeroPhase(const Eigen::VectorXd& signal, double interval, double cutoff) {
    const Eigen::Index n = signal.size();
    const double w = std::tan(kPi * cutoff * interval);
    const Eigen::Index pad = std::min<Eigen::Index>(n - 1, static_cast<Eigen::Index>(3 / (cutoff * interval)) + 4);
    std::vector<double> x(n + 2 * pad);
    for (Eigen::Index k = 0; k < pad; ++k) {
        x[k] = 2 * signal[0] - signal[pad - k];
        x[n + pad + k] = 2 * signal[n - 1] - signal[n - 2 - k];
    }
    std::copy(signal.data(), signal.data() + n, x.begin() + pad);
    filterOnce(x, w);
    std::reverse(x.begin(), x.end());
    filterOnce(x, w);
    std::reverse(x.begin(), x.end());
    return Eigen::Map<const Eigen::VectorXd>(x.data() + pad, n);
}

Derivatives differentiate(const Eigen::VectorXd& x, double h) {
    static const double first[4][4] = {{1.0 / 2, 0, 0, 0},
                                       {2.0 / 3, -1.0 / 12, 0, 0},
                                       {3.0 / 4, -3.0 / 20, 1.0 / 60, 0},
                                       {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280}};
    static const double second[4][4] = {{1, 0, 0, 0},
                                        {4.0 / 3, -1.0 / 12, 0, 0},
                                        {3.0 / 2, -3.0 / 20, 1.0 / 90, 0},
                                        {8.0 / 5, -1.0 / 5, 8.0 / 315, -1.0 / 560}};
    const Eigen::Index n = x.size();
    Derivatives result;
    result.first.resize(n);
    result.second.resize(n);
    for (Eigen::Index k = 1; k + 1 < n; ++k) {
        const Eigen::Index reach = std::min<Eigen::Index>({4, k, n - 1 - k});
        double d1 = 0, d2 = 0;
        for (Eigen::Index j = 1; j <= reach; ++j) {
            d1 += first[reach - 1][j - 1] * (x[k + j] - x[k - j]);
            d2 += second[reach - 1][j - 1] * ((x[k + j] - x[k]) + (x[k - j] - x[k]));
        }
        result.first[k] = d1 / h;
        result.second[k] = d2 / (h * h);
    }
    result.first[0] = (-3 * x[0] + 4 * x[1] - x[2]) / (2 * h);
    result.first[n - 1] = (3 * x[n - 1] - 4 * x[n - 2] + x[n - 3]) / (2 * h);
    result.second[0] = result.second[1];
    result.second[n - 1] = result.second[n - 2];
    return result;
}

double findCutoff(const Eigen::MatrixXd& signals, double interval) {
    // Standing out means twice the floor, averaged over a sixth of an octave.
    constexpr double ratio = 2, band = 1.1225;
    const double nyquist = 0.5 / interval;
    double highest = 0;
    for (Eigen::Index row = 0; row < signals.rows(); ++row) {
        const Spectrum spectrum = calcSpectrum(signals.row(row).transpose(), interval, 4096);
        const Eigen::Index bins = spectrum.density.size();
        const auto mean = [&](double from, double to) {
            const auto first = static_cast<Eigen::Index>(from / nyquist * static_cast<double>(bins - 1));
            const auto last =
                std::max(first + 1, static_cast<Eigen::Index>(to / nyquist * static_cast<double>(bins - 1)));
            return spectrum.density.segment(first, std::min(last, bins) - first).mean();
        };
        const double floor = mean(0.8 * nyquist, nyquist);
        for (double f = 0.6 * nyquist; f > std::max(highest, 0.01 * nyquist); f /= band) {
            if (mean(f / band, f) > ratio * floor) highest = std::max(highest, f);
        }
    }
    return std::clamp(1.5 * highest, 0.02 * nyquist, 0.5 * nyquist);
}

double findAccelerationEnd(const Eigen::MatrixXd& signals, double interval) {
    // Standing out as in findCutoff. What is left out of a tenth of the power is a third of the RMS.
    constexpr double ratio = 2, share = 0.9;
    Eigen::VectorXd power;
    Spectrum spectrum;
    for (Eigen::Index row = 0; row < signals.rows(); ++row) {
        spectrum = calcSpectrum(signals.row(row).transpose(), interval, 4096);
        const Eigen::Index bins = spectrum.density.size(), top = bins / 5;
        const double floor = ratio * spectrum.density.tail(top).mean();
        const Eigen::ArrayXd above = (spectrum.density.array() - floor).cwiseMax(0.0);
        if (power.size() == 0) power = Eigen::VectorXd::Zero(bins);
        power += (above * spectrum.frequency.array().pow(4)).matrix();
    }
    const double all = power.sum();
    if (!(all > 0)) return 0;
    double below = 0;
    for (Eigen::Index bin = 0; bin < power.size(); ++bin) {
        below += power[bin];
        if (below >= share * all) return spectrum.frequency[bin];
    }
    return spectrum.frequency[power.size() - 1];
}

namespace {

/// c1, c2 and their derivatives with respect to s = θ². Below s = 0.04 the series to s³ are exact to 1e-13.
struct Coefficients {
    double c1, c2, c1_slope, c2_slope;
};

Coefficients calcCoefficients(double s) {
    if (s < 0.04) {
        return {0.5 - s / 24 * (1 - s / 30 * (1 - s / 56)), 1.0 / 6 - s / 120 * (1 - s / 42 * (1 - s / 72)),
                -1.0 / 24 + s / 360 * (1 - s * 3 / 112 * (1 - s / 67.5)),
                -1.0 / 120 + s / 2520 * (1 - s / 48 * (1 - s / 82.5))};
    }
    const double angle = std::sqrt(s), sine = std::sin(angle), versine = 1 - std::cos(angle);
    return {versine / s, (angle - sine) / (s * angle), (angle * sine / 2 - versine) / (s * s),
            (versine - 3 * (angle - sine) / angle) / (2 * s * s)};
}

/// B⁻¹ b = b − θ × b / 2 + e θ × (θ × b), e = (1 − θ/2 cot θ/2)/θ².
Eigen::Vector3d solveLeftJacobian(const Eigen::Vector3d& theta, const Eigen::Vector3d& b) {
    const double s = theta.squaredNorm();
    const double half = std::sqrt(s) / 2;
    const double e = s < 1e-3 ? 1.0 / 12 + s / 720 + s * s / 30240 : (1 - half / std::tan(half)) / s;
    const Eigen::Vector3d u = theta.cross(b);
    return b - 0.5 * u + e * theta.cross(u);
}

/// B' θ' = c1' u + c2' θ × u + c2 θ' × u, u = θ × θ'.
Eigen::Vector3d calcBias(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot) {
    const Coefficients c = calcCoefficients(theta.squaredNorm());
    const double s_rate = 2 * theta.dot(theta_dot);
    const Eigen::Vector3d u = theta.cross(theta_dot);
    return c.c1_slope * s_rate * u + c.c2_slope * s_rate * theta.cross(u) + c.c2 * theta_dot.cross(u);
}

Eigen::Vector3d multiply(const Eigen::Vector3d& theta, const Eigen::Vector3d& b) {
    const Coefficients c = calcCoefficients(theta.squaredNorm());
    const Eigen::Vector3d u = theta.cross(b);
    return b + c.c1 * u + c.c2 * theta.cross(u);
}

}  // namespace

Eigen::Vector3d calcAngularVelocity(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot) {
    return multiply(theta, theta_dot);
}

Eigen::Vector3d calcAngularAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                        const Eigen::Vector3d& theta_dot_dot) {
    return multiply(theta, theta_dot_dot) + calcBias(theta, theta_dot);
}

Eigen::Vector3d calcVectorRate(const Eigen::Vector3d& theta, const Eigen::Vector3d& w) {
    return solveLeftJacobian(theta, w);
}

Eigen::Vector3d calcVectorAcceleration(const Eigen::Vector3d& theta, const Eigen::Vector3d& theta_dot,
                                       const Eigen::Vector3d& alpha) {
    return solveLeftJacobian(theta, alpha - calcBias(theta, theta_dot));
}

}  // namespace wems::identify
