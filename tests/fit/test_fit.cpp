// Stiffness, clearance, stops and damping from a recording alone, against the truth of an independent integrator.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "identify/fit/fit.hpp"
#include "models/common/error.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/sanitized.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

constexpr test::SensorNoise sensors{1e-6, 0.01};

MountModel makeDevice() {
    return readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
}

/// A fast sweep over the same band: a quarter of the samples of the usual one.
test::SweepSettings makeSweep(const Eigen::Vector3d& force) {
    test::SweepSettings settings;
    settings.force = force;
    settings.octaves_per_minute = 16;
    return settings;
}

RunMotion measure(const test::SyntheticRun& run, const MountModel& believed, std::uint64_t seed,
                  const test::SensorNoise& noise = sensors) {
    return estimateMotion(test::record(run, noise, seed), believed);
}

/// Value and size (sum of the magnitudes) of a text such as `1.x.stiffness + 2 3.y.stiffness - 4.y.stiffness`.
struct Combination {
    double value = 0, size = 0;
};
Combination evaluate(const std::string& combination, const MountModel& model) {
    std::istringstream words(combination);
    Combination sum;
    double factor = 1;
    for (std::string word; words >> word;) {
        if (word == "+" || word == "-") {
            factor = word == "-" ? -1 : 1;
            continue;
        }
        if (word.size() > 1 && word.front() == '-') {
            factor = -1;
            word.erase(0, 1);
        }
        const bool name = std::count(word.begin(), word.end(), '.') > 1;
        if (!name) {
            factor *= std::stod(word);
            continue;
        }
        sum.value += factor * getParameter(model, word);
        sum.size += std::abs(factor * getParameter(model, word));
    }
    return sum;
}

double allowedError(const std::string& name) {
    if (name.find("damping") != std::string::npos) return 0.05;
    if (name.find("clearance") != std::string::npos) return 0.01;
    const bool stop = name.find(".+.") != std::string::npos || name.find(".-.") != std::string::npos;
    return stop ? 0.02 : 0.01;
}

const FittedParameter* find(const FitResult& fit, const std::string& name) {
    const auto found = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                    [&](const FittedParameter& p) { return p.name == name; });
    return found == fit.parameters.end() ? nullptr : &*found;
}

/// Every value and every combination that is printed is right.
void checkValues(const FitResult& fit, const MountModel& truth) {
    for (const auto& parameter : fit.parameters) {
        CAPTURE(parameter.name, parameter.interval95[0], parameter.interval95[1]);
        CHECK(parameter.value == Approx(getParameter(truth, parameter.name)).epsilon(allowedError(parameter.name)));
    }
    for (const auto& group : fit.not_identifiable) {
        if (group.combination.empty()) continue;
        CAPTURE(group.combination);
        const Combination right = evaluate(group.combination, truth);
        CHECK(std::abs(group.value - right.value) < allowedError(group.names.front()) * right.size);
    }
}

TEST_CASE("At 200 N axial and oblique the excited stiffnesses come out within 1 %, damping within 5 %") {
    const MountModel truth = makeDevice();
    const std::uint64_t seed = test::drawSeed();
    CAPTURE(seed);
    const MountModel believed = test::perturb(truth, 0.25, seed);
    const Eigen::Vector3d force = GENERATE(Eigen::Vector3d(0, 0, 200), Eigen::Vector3d(140, 140, 0));
    CAPTURE(force.transpose());
    const FitResult fit = fitMount({measure(test::simulateSweep(truth, makeSweep(force)), believed, seed)}, believed);
    checkValues(fit, truth);
    if (force.z() > 0)
        for (const char* name : {"1.z.stiffness", "2.z.stiffness", "3.z.stiffness", "4.z.stiffness"})
            CHECK(find(fit, name) != nullptr);
    for (const auto& parameter : fit.parameters) {  // no stop was reached, and none is made up
        CHECK(parameter.name.find("clearance") == std::string::npos);
        CHECK(parameter.name.find(".+.") == std::string::npos);
        CHECK(parameter.name.find(".-.") == std::string::npos);
    }
}

TEST_CASE("At 500 N clearances come out within 1 %, stops within 2 %") {
    const MountModel truth = makeDevice();
    const std::uint64_t seed = test::drawSeed();
    CAPTURE(seed);
    const MountModel believed = test::perturb(truth, 0.25, seed);
    auto sweep = makeSweep({0, 0, 500});
    sweep.steps_per_sample = 8;
    const FitResult fit = fitMount({measure(test::simulateSweep(truth, sweep), believed, seed)}, believed);
    checkValues(fit, truth);
    CHECK(find(fit, "4.z.-.clearance") != nullptr);
    CHECK(find(fit, "4.z.-.stiffness") != nullptr);
    CHECK(find(fit, "4.z.+.clearance") != nullptr);
}

TEST_CASE("One plot that is 20 % soft is found as such") {
    MountModel truth = makeDevice();
    const std::uint64_t seed = test::drawSeed();
    std::mt19937_64 random(seed);
    const int soft = std::uniform_int_distribution<int>(1, 4)(random);
    CAPTURE(seed, soft);
    const MountModel believed = truth;
    truth.connections[soft - 1].axis[2].stiffness *= 0.8;
    const FitResult fit =
        fitMount({measure(test::simulateSweep(truth, makeSweep({0, 0, 200})), believed, seed)}, believed);
    for (int i = 1; i <= 4; ++i) {
        const std::string name = std::to_string(i) + ".z.stiffness";
        const FittedParameter* parameter = find(fit, name);
        CAPTURE(name);
        REQUIRE(parameter != nullptr);
        CHECK(parameter->value == Approx(getParameter(truth, name)).epsilon(0.01));
        const double standard = getParameter(believed, name);
        if (i == soft) CHECK((parameter->interval95[1] < 0.9 * standard));
    }
}

TEST_CASE("What a run does not excite is named with the combination that is known, and no number is printed for it") {
    const MountModel truth = makeDevice();
    const std::uint64_t seed = test::drawSeed();
    CAPTURE(seed);
    const FitResult fit = fitMount({measure(test::simulateSweep(truth, makeSweep({0, 0, 200})), truth, seed)}, truth);
    REQUIRE(!fit.not_identifiable.empty());
    for (const auto& group : fit.not_identifiable) {
        for (const auto& name : group.names) CHECK(find(fit, name) == nullptr);
        CHECK(!group.separate_by.empty());
        if (!group.combination.empty()) {
            CAPTURE(group.combination);
            CHECK(group.interval95[0] < group.value);
            CHECK(group.interval95[1] > group.value);
        }
    }
    const bool stop_named =
        std::any_of(fit.not_identifiable.begin(), fit.not_identifiable.end(), [](const UnidentifiedGroup& group) {
            return group.names.front() == "4.z.-.clearance" && group.reason.find("not reached") != std::string::npos;
        });
    CHECK(stop_named);
}

TEST_CASE("A name that cannot be freed and a run that is too short are refused") {
    const MountModel truth = makeDevice();
    auto settings = makeSweep({0, 0, 200});
    settings.octaves_per_minute = 600;
    test::SyntheticRun run = test::simulateSweep(truth, settings);
    FitOptions options;
    options.free_body = {"body.colour"};
    const RunMotion motion = measure(run, truth, 1);
    CHECK_THROWS_AS(fitMount({motion}, truth, options), InputError);
    CHECK_THROWS_AS(fitMount({}, truth), InputError);
    FitOptions wide;
    wide.knot_time = 1;
    CHECK_THROWS_WITH(fitMount({motion}, truth, wide), Catch::Contains("too short for a fit"));
}

// Without noise the rigid fit leaves what the text's digits and its own arithmetic leave: no scatter of the gains,
// however small the motion along some axes, and nothing less known than with noise.
TEST_CASE("A recording without noise is known best of all") {
    const MountModel truth = makeDevice();
    const double force = GENERATE(200.0, 500.0);
    if (test::kSanitized && force > 200) return;
    const test::SyntheticRun run = test::simulateSweep(truth, makeSweep({0, 0, force}));
    const std::uint64_t seed = test::drawSeed();
    CAPTURE(seed, force);
    const MountModel believed = test::perturb(truth, 0.25, seed);
    const RunMotion clean = measure(run, believed, seed, {0, 0}), noisy = measure(run, believed, seed);
    for (const PartMotion* part : {&clean.mobile, &clean.fixed}) {
        CHECK(part->displacement_calibration.gain_scatter < 1e-4);
        CHECK(part->acceleration_calibration.gain_scatter < 1e-4);
    }
    const FitResult fit = fitMount({clean}, believed), with_noise = fitMount({noisy}, believed);
    for (const FittedParameter& p : with_noise.parameters) {
        CAPTURE(p.name);
        const FittedParameter* same = find(fit, p.name);
        REQUIRE(same != nullptr);
        CHECK(std::abs(same->value / getParameter(truth, p.name) - 1) < 0.2 * allowedError(p.name));
    }
}

TEST_CASE("Coverage of the 95 % intervals over 100 repetitions", "[.coverage]") {
    const MountModel truth = makeDevice();
    const double force = GENERATE(200.0, 500.0);
    auto sweep = makeSweep({0, 0, force});
    sweep.octaves_per_minute = 4;
    sweep.sample_rate = 1000;
    sweep.steps_per_sample = 16;
    const test::SyntheticRun run = test::simulateSweep(truth, sweep);
    std::map<std::string, std::array<int, 2>> held;  // kind → inside, all
    std::uint64_t seed = test::drawSeed();
    WARN("first seed " << seed << ", " << force << " N axial");
    const auto count = [&](const std::string& name, const std::array<double, 2>& interval, double value) {
        const std::string kind = name.substr(name.rfind('.') + 1);
        for (const auto& key : {kind, std::string("all")}) {
            held[key][0] += interval[0] <= value && value <= interval[1] ? 1 : 0;
            ++held[key][1];
        }
    };
    for (int repetition = 0; repetition < 100; ++repetition, ++seed) {
        const MountModel believed = test::perturb(truth, 0.25, seed);
        const FitResult fit = fitMount({measure(run, believed, seed)}, believed);
        for (const auto& p : fit.parameters) count(p.name, p.interval95, getParameter(truth, p.name));
        for (const auto& group : fit.not_identifiable)
            if (!group.combination.empty())
                count("combination", group.interval95, evaluate(group.combination, truth).value);
    }
    for (const auto& [kind, numbers] : held)
        WARN(kind << ": " << numbers[0] << " of " << numbers[1] << " intervals hold the truth");
    CHECK(held["all"][0] >= 0.9 * held["all"][1]);
}

}  // namespace
}  // namespace wems::identify
