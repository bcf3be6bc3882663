#include "models/shock_response.hpp"

#include <algorithm>
#include <cmath>

#include "models/pi.hpp"

namespace wems {

ShockResponse calcShockResponse(const Eigen::VectorXd& acceleration, double interval,
                                const std::vector<double>& frequency, double quality) {
    const Eigen::Index count = frequency.size();
    ShockResponse response;
    response.frequency = frequency;
    response.positive.resize(count);
    response.negative.resize(count);
    const double zeta = 1 / (2 * quality);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double f = frequency[i];
        const double omega = kTwoPi * f, damped = omega * std::sqrt(1 - zeta * zeta);
        const double E = std::exp(-zeta * omega * interval), K = damped * interval;
        const double C = E * std::cos(K), S = E * std::sin(K) / K;
        const double b0 = 1 - S, b1 = 2 * (S - C), b2 = E * E - S, a1 = -2 * C, a2 = E * E;
        const auto after = static_cast<Eigen::Index>(std::ceil(1 / (f * interval)));
        double x1 = 0, x2 = 0, y1 = 0, y2 = 0, highest = 0, lowest = 0;
        for (Eigen::Index k = 0; k < acceleration.size() + after; ++k) {
            const double x = k < acceleration.size() ? acceleration[k] : 0;
            const double y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
            highest = std::max(highest, y);
            lowest = std::min(lowest, y);
            x2 = x1;
            x1 = x;
            y2 = y1;
            y1 = y;
        }
        response.positive[i] = highest;
        response.negative[i] = -lowest;
    }
    response.maximax = response.positive.cwiseMax(response.negative);
    return response;
}

std::vector<double> makeOctaves(double from, double to, int per_octave) {
    std::vector<double> frequency;
    for (int k = 0;; ++k) {
        const double f = from * std::exp2(static_cast<double>(k) / per_octave);
        if (f > to * (1 + 1e-9)) return frequency;
        frequency.push_back(f);
    }
}

}  // namespace wems
