#include "plugin/cubic_spline.hpp"

#include <algorithm>
#include <utility>

namespace wems::plugin {

CubicSpline::CubicSpline(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), curvature_(x_.size(), 0.0) {
    const std::size_t n = x_.size();
    if (n < 3) return;
    // Thomas algorithm on h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i − slope_{i-1}).
    std::vector<double> ratio(n, 0.0);
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const double before = x_[i] - x_[i - 1], after = x_[i + 1] - x_[i];
        const double right = 6 * ((y_[i + 1] - y_[i]) / after - (y_[i] - y_[i - 1]) / before);
        const double pivot = 2 * (before + after) - before * ratio[i - 1];
        ratio[i] = after / pivot;
        curvature_[i] = (right - before * curvature_[i - 1]) / pivot;
    }
    for (std::size_t i = n - 2; i > 0; --i) curvature_[i] -= ratio[i] * curvature_[i + 1];
}

double CubicSpline::calcValue(double x) const {
    if (x <= x_.front()) return y_.front();
    if (x >= x_.back()) return y_.back();
    const auto i = static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
    const double h = x_[i + 1] - x_[i];
    const double b = (x - x_[i]) / h, a = 1 - b;
    return a * y_[i] + b * y_[i + 1] +
           ((a * a * a - a) * curvature_[i] + (b * b * b - b) * curvature_[i + 1]) * h * h / 6;
}

}  // namespace wems::plugin
