#include "identify/inspect/segment_spectra.hpp"

#include <cmath>

#include "identify/motion/fftw_plan.hpp"
#include "models/pi.hpp"

namespace wems::identify {

std::vector<std::vector<std::complex<double>>> transformSegments(const std::vector<double>& signal,
                                                                 std::size_t length) {
    std::vector<double> block(length);
    std::vector<std::complex<double>> spectrum(length / 2 + 1);
    const FftwPlan plan(
        fftw_plan_dft_r2c_1d(static_cast<int>(length), block.data(), asFftw(spectrum.data()), FFTW_ESTIMATE));
    std::vector<std::vector<std::complex<double>>> segments;
    for (std::size_t start = 0; start + length <= signal.size(); start += length / 2) {
        for (std::size_t i = 0; i < length; ++i) {
            const double phase = kTwoPi * (static_cast<double>(i) + 0.5) / static_cast<double>(length);
            const double value = signal[start + i];
            block[i] = std::isfinite(value) ? (0.5 - 0.5 * std::cos(phase)) * value : 0;
        }
        fftw_execute(plan.get());
        segments.push_back(spectrum);
    }
    return segments;
}

}  // namespace wems::identify
