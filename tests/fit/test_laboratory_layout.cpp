// The same run seen by the ideal layout and by a laboratory's own: the same device comes out, within its intervals.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/fit/fit.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/laboratory_layout.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
TEST_CASE("Markers away from the connections and turned sensors identify the same device") {
    const MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const std::uint64_t seed = test::drawSeed();
    CAPTURE(seed);
    const test::SensorNoise noise{1e-6, 0.01};
    test::SweepSettings settings;
    settings.force = {0, 0, 200};
    settings.octaves_per_minute = 16;
    const test::SyntheticRun run = test::simulateSweep(truth, settings);
    MountModel believed = test::perturb(truth, 0.25, seed);
    const FitResult ideal = fitMount({estimateMotion(test::record(run, noise, seed), believed)}, believed);
    believed.places = test::makeLayout(seed);
    const Recording recording = test::recordLayout(run, believed.places, noise, seed + 1);
    const FitResult laboratory = fitMount({estimateMotion(recording, believed)}, believed);
    int compared = 0;
    for (const FittedParameter& parameter : laboratory.parameters) {
        if (parameter.name.find("z.stiffness") == std::string::npos) continue;
        const auto same = std::find_if(ideal.parameters.begin(), ideal.parameters.end(),
                                       [&](const FittedParameter& other) { return other.name == parameter.name; });
        REQUIRE(same != ideal.parameters.end());
        ++compared;
        const double own = parameter.interval95[1] - parameter.interval95[0];
        const double other = same->interval95[1] - same->interval95[0];
        CAPTURE(parameter.name, parameter.value, same->value, own, other);
        // Difference of two independent estimates: 95 % intervals of ±1.96 σ each; four σ of the difference.
        CHECK(std::abs(parameter.value - same->value) < 4 * std::hypot(own, other) / 3.92);
        CHECK(parameter.value == Approx(getParameter(truth, parameter.name)).epsilon(0.01));
    }
    CHECK(compared == 4);
}

}  // namespace wems::identify
