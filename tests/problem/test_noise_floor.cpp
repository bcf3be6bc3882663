#include <catch2/catch.hpp>
#include <cmath>

#include "identify/updating/free_runs.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

// The true model leaves the noise and nothing else. Accelerations integrated twice have nearly all of theirs at the
// lowest frequencies: a white noise of the same RMS leaves a tenth to a half of what 1/f noise does.
TEST_CASE("The noise floor of integrated accelerations is what the true model leaves") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    hidden::Random random(seed);
    auto hidden = hidden::drawCase("none", random, hidden::Sensors::accelerations);
    // Contact would fold, and amplify what is small.
    for (MountModel* model : {&hidden.base, &hidden.truth, &hidden.believed})
        for (Connection& connection : model->connections)
            for (AxisLaw& law : connection.axis) law.stops.clear();
    hidden.acceleration_noise *= 3;
    hidden.sensors.pink = 1;
    MountModel believed = hidden.base;
    for (std::size_t i = 0; i < kToleranceKeys.size(); ++i) believed.tolerances.set(static_cast<ToleranceOf>(i), 0.0);
    const TestProblem problem({hidden::recordForward(hidden, 0, seed), hidden::recordForward(hidden, 1, seed)}, {},
                              believed);
    const FreeRuns runs(problem, 0, problem.runs().size());
    const FreeError left = runs.calcError(believed);
    const double floor = runs.calcNoiseFloor(believed, seed);
    CAPTURE(left.error, left.noise_floor, floor);
    // Few bins hold most of the noise. Six seeds: 0.96 to 1.10.
    CHECK(left.error < 1.3 * floor);
    CHECK(left.error > 0.7 * floor);
}
