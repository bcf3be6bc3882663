// Spectra of a whole run: an oscillator on a base that moves at random, and what is left of its clearance.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/spectra/run_spectra.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"
#include "models/excitation.hpp"
#include "models/linear_response.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kFrequency = 20, kRatio = 0.05;

/// Steady response of an oscillator to a base that moves as a sum of sines, exact.
Recording makeRun(double duration, double rate) {
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> draw(0, kTwoPi);
    Recording run;
    run.file = "run.csv";
    const auto n = static_cast<std::size_t>(duration * rate);
    std::vector<double> base(n), mobile(n), fixed_x(n), mobile_x(n);
    const double w0 = kTwoPi * kFrequency;
    for (int line = int(5 * duration); line <= int(60 * duration); ++line) {
        const double w = kTwoPi * line / duration, phase = draw(generator);
        const std::complex<double> loss(0, 2 * kRatio * w0 * w);
        const std::complex<double> T = (w0 * w0 + loss) / (w0 * w0 - w * w + loss);
        for (std::size_t k = 0; k < n; ++k) {
            const std::complex<double> e = 0.1 * std::polar(1.0, w * double(k) / rate + phase);
            base[k] += e.real();
            mobile[k] += (T * e).real();
            fixed_x[k] -= e.real() / (w * w);
            mobile_x[k] -= (T * e).real() / (w * w);
        }
    }
    for (std::size_t k = 0; k < n; ++k) run.time.push_back(double(k) / rate);
    const auto add = [&](const char* name, const char* unit, std::vector<double> values) {
        run.channels.push_back({name, unit, std::move(values), 0});
    };
    add("base.az", "m/s^2", base);
    add("fixed.1.az", "m/s^2", base);
    add("mobile.1.az", "m/s^2", mobile);
    add("fixed.1.z", "m", fixed_x);
    add("mobile.1.z", "m", mobile_x);
    return run;
}

}  // namespace

TEST_CASE("transmissibility of an oscillator: peak, frequency, damping, and the curve within its circles") {
    const Recording run = makeRun(40, 256);
    SpectraSettings settings;
    settings.resolution = 0.25;
    const RunSpectra spectra = calcRunSpectra(run, nullptr, settings);
    CHECK(spectra.reference == "base.az");
    REQUIRE(spectra.transmissibilities.size() == 1);
    const ChannelTransfer& transfer = spectra.transmissibilities[0];
    CHECK(transfer.input == "fixed.1.az");
    CHECK(transfer.output == "mobile.1.az");
    CHECK(transfer.unit == "-");
    REQUIRE(transfer.peaks.size() == 1);
    const double largest = std::sqrt(1 + 4 * kRatio * kRatio) / (2 * kRatio);  // near enough to the peak
    CHECK(transfer.peaks[0].frequency == Approx(kFrequency).epsilon(0.01));
    CHECK(transfer.peaks[0].amplitude == Approx(largest).epsilon(0.03));
    CHECK(transfer.peaks[0].damping_ratio == Approx(kRatio).epsilon(0.1));
    CHECK(transfer.estimate.coherence[transfer.peaks[0].bin] > 0.98);
    // Levels: 0.1 amplitude at each of 2201 lines.
    CHECK(spectra.channels[0].rms == Approx(0.1 * std::sqrt(2201 / 2.0)).epsilon(0.01));
    CHECK(spectra.spectra.density.col(0).sum() * spectra.spectra.resolution ==
          Approx(std::pow(spectra.channels[0].rms, 2)).epsilon(0.03));
    CHECK(spectra.shocks.size() == 3);
    REQUIRE(spectra.margins.connections.size() == 1);
    double highest = -1e9, lowest = 1e9;
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        const double q = run.channels[4].values[k] - run.channels[3].values[k];
        highest = std::max(highest, q);
        lowest = std::min(lowest, q);
    }
    CHECK(spectra.margins.connections[0].name == "1.z");
    CHECK(spectra.margins.connections[0].highest == Approx(highest).epsilon(1e-9));
    CHECK(spectra.margins.connections[0].lowest == Approx(lowest).epsilon(1e-9));

    settings.reference = "mobile.1.az";
    CHECK(calcRunSpectra(run, nullptr, settings).transfers.front().input == "mobile.1.az");
    settings.reference = "load.fz";
    CHECK_THROWS_AS(calcRunSpectra(run, nullptr, settings), InputError);
    settings.reference.clear();
    settings.resolution = 1e-3;
    CHECK_THROWS_AS(calcRunSpectra(run, nullptr, settings), InputError);
}

TEST_CASE("peaks: two resonances are found, a shoulder and a slope are none") {
    Eigen::VectorXd frequency = Eigen::VectorXd::LinSpaced(991, 1, 100), amplitude(991);
    for (Eigen::Index k = 0; k < frequency.size(); ++k) {
        const auto resonance = [&](double f0, double zeta) {
            const double r = frequency[k] / f0;
            return 1.0 / std::complex<double>(1 - r * r, 2 * zeta * r);
        };
        amplitude[k] = std::abs(resonance(20, 0.02) + 0.4 * resonance(60, 0.01));
    }
    const auto peaks = findPeaks(frequency, amplitude, 1, 100);
    REQUIRE(peaks.size() == 2);
    CHECK(peaks[0].frequency == Approx(20).epsilon(0.002));
    CHECK(peaks[0].damping_ratio == Approx(0.02).epsilon(0.05));
    CHECK(peaks[1].frequency == Approx(60).epsilon(0.002));
    CHECK(peaks[0].amplitude == Approx(25).epsilon(0.03));
    CHECK(findPeaks(frequency, amplitude, 30, 50).empty());
}
