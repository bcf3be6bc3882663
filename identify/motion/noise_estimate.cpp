#include "identify/motion/noise_estimate.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace wems::identify {

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

namespace {

double medianOfChiSquared(int degrees_of_freedom) {
    return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), 0.5);
}

}  // namespace

double medianDeviation(const std::vector<double>& values, double centre) {
    constexpr double of_normal = 1.4826;  // standard deviation over median absolute deviation
    std::vector<double> deviations;
    deviations.reserve(values.size());
    for (const double value : values) deviations.push_back(std::abs(value - centre));
    return of_normal * median(std::move(deviations));
}

double estimateNoiseFromResiduals(const Eigen::MatrixXd& residuals, int redundancy) {
    const Eigen::Index samples = residuals.cols();
    if (redundancy < 1 || samples < 3) return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> sums(samples - 2);
    for (Eigen::Index k = 1; k + 1 < samples; ++k)
        sums[k - 1] = (residuals.col(k - 1) - 2 * residuals.col(k) + residuals.col(k + 1)).squaredNorm();
    return std::sqrt(median(std::move(sums)) / (6 * medianOfChiSquared(redundancy)));
}

double estimateNoiseFromSignal(const Eigen::VectorXd& x) {
    if (x.size() < 7) return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> squares;
    squares.reserve(x.size());
    for (Eigen::Index k = 3; k + 3 < x.size(); ++k) {
        const double sixth = x[k - 3] + x[k + 3] - 6 * (x[k - 2] + x[k + 2]) + 15 * (x[k - 1] + x[k + 1]) - 20 * x[k];
        squares.push_back(sixth * sixth);
    }
    return std::sqrt(median(std::move(squares)) / (924 * medianOfChiSquared(1)));
}

double calcCorrelationLength(const Eigen::VectorXd& residual) {
    const Eigen::Index n = residual.size();
    const double variance = residual.squaredNorm() / static_cast<double>(n);
    if (variance <= 0) return 1;
    double length = 1;
    for (Eigen::Index lag = 1; lag < n / 4; ++lag) {
        const double rho = residual.head(n - lag).dot(residual.tail(n - lag)) / (static_cast<double>(n) * variance);
        if (rho < 0.05) break;
        length += 2 * rho;
    }
    return length;
}

}  // namespace wems::identify
