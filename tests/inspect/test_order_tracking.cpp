// Orders of a signal that is known in closed form.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/inspect/order_tracking.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {}  // namespace

TEST_CASE("Amplitude and phase of three orders along a sweep") {
    // Load sin φ; response with orders of known amplitude, each with a known phase against the load.
    const double from = 5, to = 50, rate = 1.0 / 15 * std::log(10.0);
    const unsigned seed = 3;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 1e-7);
    Recording run;
    Channel load{"load.fz", "", {}, 0}, z{"mobile.1.z", "", {}, 0};
    for (int k = 0; k < 15000; ++k) {
        const double t = k / 1000.0, f = from * std::exp(rate * t), phase = kTwoPi * (f - from) / rate;
        run.time.push_back(t);
        load.values.push_back(200 * std::cos(phase));
        const double a = 1e-3 * f / to;
        z.values.push_back(2e-4 + a * std::cos(phase - 0.7) + 0.3 * a * std::cos(2 * phase + 0.4) +
                           0.1 * a * std::cos(3 * phase - 1.5) + noise(random));
    }
    run.channels = {load, z};
    const SweptFrequency swept = findSweptFrequency(run);
    REQUIRE(swept.is_sine);
    const OrderTracking orders = trackOrders(run, swept, 60);
    CHECK(orders.reference == "load.fz");
    REQUIRE(orders.tracks.size() == 2);
    int points = 0;
    for (std::size_t p = 0; p < orders.hertz.size(); ++p) {
        const Eigen::Index i = p;
        if (!std::isfinite(orders.tracks[1].amplitude(0, i)) || orders.hertz[p] < 6 || orders.hertz[p] > 45) continue;
        ++points;
        const double a = 1e-3 * from * std::exp(rate * orders.time[p]) / to;
        CHECK(orders.tracks[0].amplitude(0, i) == Approx(200).epsilon(0.02));
        CHECK(orders.tracks[0].phase(0, i) == Approx(0).margin(1e-12));
        CHECK(orders.tracks[1].amplitude(0, i) == Approx(a).epsilon(0.03));
        CHECK(orders.tracks[1].amplitude(1, i) == Approx(0.3 * a).epsilon(0.06));
        CHECK(orders.tracks[1].amplitude(2, i) == Approx(0.1 * a).epsilon(0.1));
        CHECK(orders.tracks[1].phase(0, i) == Approx(-0.7).margin(0.03));
        CHECK(orders.tracks[1].phase(1, i) == Approx(0.4).margin(0.06));
        CHECK(orders.tracks[1].phase(2, i) == Approx(-1.5).margin(0.1));
    }
    CHECK(points > 40);
}

}  // namespace wems::identify
