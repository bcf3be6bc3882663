// A rehearsed run beside the run itself, which an integrator of its own has made.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/plan/rehearsal.hpp"
#include "models/excitation.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/plan/plan_case.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

MountModel makeDevice() {
    return readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
}

test::SweepSettings makeSweep(const Eigen::Vector3d& force) {
    test::SweepSettings settings;
    settings.force = force;
    settings.octaves_per_minute = 20;
    settings.sample_rate = 1000;
    return settings;
}

double findWidth(const FitResult& fit, const std::string& name) {
    for (const FittedParameter& parameter : fit.parameters)
        if (parameter.name == name) return parameter.interval95[1] - parameter.interval95[0];
    return NAN;
}

}  // namespace

TEST_CASE("What a rehearsed run adds to the intervals is what the recorded one adds") {
    const MountModel truth = makeDevice();
    const std::uint64_t seed = test::drawSeed();
    CAPTURE(seed);
    const MountModel believed = test::perturb(truth, 0.1, seed);
    const test::SensorNoise noise{2e-6, -1};
    const Recording axial = test::record(test::simulateSweep(truth, makeSweep({0, 0, 150})), noise, seed + 1);
    const Recording oblique = test::record(test::simulateSweep(truth, makeSweep({100, 50, 100})), noise, seed + 2);
    const std::vector<RunMotion> runs = testing::measureAll({axial, oblique}, believed);
    const FitResult recorded = fitMount(runs, believed);

    AskedSetup asked;
    asked.force = 200;
    const TestSetup setup = findTestSetup({runs[0]}, {axial}, believed, asked);
    CHECK(setup.mobile_noise.displacement == Approx(2e-6).epsilon(0.03));
    CHECK(setup.fixed_noise.displacement == Approx(2e-6).epsilon(0.03));
    PlannedRun run;
    run.level = {100, 50, 100};
    run.octaves_per_minute = 20;
    run.sensors = setup.kinds();
    const FitResult rehearsed = fitMount({runs[0], Rehearsal(setup, recorded.model).measure(run)}, believed);

    // Both widths are estimated, from about 100 blocks of time each: a standard deviation of 7 % each, 10 % of the
    // ratio. Of some 25 parameters one in a thousand draws is beyond four of them. Their median has a standard
    // deviation of 2.5 %: never beyond 12 % by chance, while widths all wrong by a fifth are in 99 of 100 draws.
    std::vector<double> ratios;
    for (const FittedParameter& parameter : recorded.parameters) {
        const double width = findWidth(rehearsed, parameter.name);
        CAPTURE(parameter.name);
        REQUIRE(std::isfinite(width));
        ratios.push_back(width / (parameter.interval95[1] - parameter.interval95[0]));
        CHECK(std::abs(std::log(ratios.back())) < 0.4);
    }
    REQUIRE(ratios.size() >= 8);
    std::sort(ratios.begin(), ratios.end());
    CHECK(std::abs(std::log(ratios[ratios.size() / 2])) < 0.12);
    CHECK(rehearsed.not_identifiable.size() == recorded.not_identifiable.size());
}

TEST_CASE("A rehearsed base motion: displacement and acceleration of the table belong together") {
    MountModel model = makeDevice();
    model.bracket.clear();
    model.bracket_file.clear();
    TestSetup setup;
    setup.mobile = setup.fixed = {true, true};
    setup.has_base = true;
    PlannedRun run;
    run.excitation = Excitation::base;
    run.level = {0, 0, 2};
    run.octaves_per_minute = 40;
    run.sensors = setup.kinds();
    const Rehearsal rehearsal(setup, model);
    const Recording recording = rehearsal.record(run);
    const Channel *base = recording.find("base.az"), *moved = recording.find("fixed.2.z"),
                  *felt = recording.find("fixed.2.az");
    REQUIRE((base != nullptr && moved != nullptr && felt != nullptr));
    // The sweep itself, and the second difference of the displacement, off by (2π f / f_s)² / 12 = 0.8 % at most.
    const auto sweep = makeLogarithmicSweep(5, 50, 40);
    double worst = 0;
    for (std::size_t k = 1; k + 1 < recording.time.size(); ++k) {
        CHECK(base->values[k] == Approx(2 * sweep->value(recording.time[k])).margin(1e-9));
        CHECK(felt->values[k] == Approx(base->values[k]).margin(1e-9));
        const double second =
            (moved->values[k - 1] - 2 * moved->values[k] + moved->values[k + 1]) * run.sample_rate * run.sample_rate;
        worst = std::max(worst, std::abs(second - base->values[k]));
    }
    CHECK(worst < 0.0085 * 2);
    const RunExtent extent = rehearsal.calcExtent(run);
    CHECK(extent.base_displacement == Approx(2 / std::pow(2 * M_PI * 5, 2)).epsilon(0.35));
    CHECK(extent.stroke > 0);
}

}  // namespace wems::identify
