#include "identify/merge/resampling.hpp"

#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>

#include "models/pi.hpp"

namespace wems::identify {
namespace {

constexpr double crossings = 32;
constexpr double beta = 8;
constexpr double cutoff_share = 0.464;  // of the lower rate: the stop band begins at its half
constexpr int table_steps = 512;        // for each zero crossing

/// The windowed sinc over |x| in zero crossings, tabulated and linearly interpolated.
class Kernel {
public:
    Kernel() {
        const double scale = boost::math::cyl_bessel_i(0, beta);
        const std::size_t count = crossings * table_steps;
        table_.resize(count + 2, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            const double x = static_cast<double>(i) / table_steps, share = x / crossings;
            const double window = boost::math::cyl_bessel_i(0, beta * std::sqrt(1 - share * share)) / scale;
            table_[i] = (i == 0 ? 1.0 : std::sin(kPi * x) / (kPi * x)) * window;
        }
    }

    double operator()(double x) const {
        const double at = std::abs(x) * table_steps;
        const auto i = static_cast<std::size_t>(at);
        if (i + 1 >= table_.size()) return 0;
        const double share = at - static_cast<double>(i);
        return (1 - share) * table_[i] + share * table_[i + 1];
    }

private:
    std::vector<double> table_;
};

}  // namespace

UniformSignal resample(const UniformSignal& signal, double start, double interval, std::size_t count) {
    const Kernel kernel;
    UniformSignal result{start, interval, std::vector<double>(count)};
    const double crossing = std::max(signal.interval, interval) / (2 * cutoff_share);  // s between zeros
    const double reach = crossings * crossing / signal.interval;                       // samples
    const auto last = static_cast<double>(signal.values.size() - 1);
    for (std::size_t k = 0; k < count; ++k) {
        const double at = (start - signal.start + static_cast<double>(k) * interval) / signal.interval;
        const auto first = static_cast<std::size_t>(std::clamp(std::ceil(at - reach), 0.0, last));
        const auto end = static_cast<std::size_t>(std::clamp(std::floor(at + reach), 0.0, last));
        double sum = 0, weights = 0;
        for (std::size_t i = first; i <= end; ++i) {
            const double weight = kernel((static_cast<double>(i) - at) * signal.interval / crossing);
            sum += weight * signal.values[i];
            weights += weight;
        }
        result.values[k] = weights != 0 ? sum / weights : 0;
    }
    return result;
}

}  // namespace wems::identify
