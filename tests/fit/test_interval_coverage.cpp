// How many of the 95 % intervals of a fit hold the truth, under what measurements are like. Campaigns: hidden.
// COVERAGE_CONDITION: part of the name of the conditions that are asked; COVERAGE_REPETITIONS: of each, 60 by default.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/updating/coarse_contacts.hpp"
#include "models/parameter_access.hpp"
#include "models/recording/recording.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/hidden/sensor_errors.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

constexpr test::SensorNoise kSensors{1e-6, 0.01};
constexpr double kRate = 1000;  // Hz
using Random = std::mt19937_64;

/// One way to measure the shipped device, pressed against its stops by 500 N axial.
struct Condition {
    std::string name;
    double rate = kRate;
    double octaves_per_minute = 16;
    test::SensorNoise noise = kSensors;
    std::function<void(Recording&, const test::SyntheticRun&, Random&)> alter = nullptr;
};

double sizeOf(const Channel& channel) {
    return channel.unit == "m" ? kSensors.displacement : channel.unit == "N" ? 0.0 : kSensors.acceleration;
}

void filterAll(Recording& recording, const test::SyntheticRun&, Random&) {
    const hidden::AntiAliasFilter filter(150 / kRate);
    for (Channel& channel : recording.channels) {
        Eigen::Map<Eigen::VectorXd> values(channel.values.data(), static_cast<Eigen::Index>(channel.values.size()));
        filter.apply(values);
    }
}

void addSlowNoise(Recording& recording, const test::SyntheticRun&, Random& random) {
    hidden::SensorErrors errors;
    errors.pink = 1;
    hidden::Random own(random());
    for (Channel& channel : recording.channels) {
        const auto count = static_cast<Eigen::Index>(channel.values.size());
        Eigen::Map<Eigen::VectorXd> values(channel.values.data(), count);
        values += sizeOf(channel) * hidden::drawNoise(errors, 1, 1.0, kRate, count, own);
    }
}

void scaleEach(Recording& recording, const test::SyntheticRun&, Random& random) {
    std::uniform_real_distribution<double> draw(-0.01, 0.01);
    for (Channel& channel : recording.channels) {
        if (channel.unit == "N") continue;
        const double gain = 1 + draw(random);
        for (double& value : channel.values) value *= gain;
    }
}

/// What every sensor reads 1 mm beside its place, in a direction of its own.
void displaceEach(Recording& recording, const test::SyntheticRun& run, Random& random) {
    std::normal_distribution<double> normal;
    std::map<std::string, Eigen::Vector3d> places;
    for (Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || channel.unit == "N") continue;
        const bool mobile = name->part == Part::mobile;
        const std::string triax = channel.name.substr(0, channel.name.rfind('.')) + channel.unit;
        if (places.count(triax) == 0)
            places[triax] = 1e-3 * Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
        const Eigen::Vector3d at = run.model.connections[run.model.connectionIndex(name->connection)].position;
        const Eigen::Vector3d moved = at + places[triax];
        for (std::size_t k = 0; k < channel.values.size(); ++k) {
            const auto s = static_cast<Eigen::Index>(k);
            channel.values[k] +=
                channel.unit == "m"
                    ? (run.calcDisplacement(mobile, s, moved) - run.calcDisplacement(mobile, s, at))[name->axis]
                    : (run.calcAcceleration(mobile, s, moved) - run.calcAcceleration(mobile, s, at))[name->axis];
        }
    }
}

void jitterStamps(Recording& recording, const test::SyntheticRun&, Random& random) {
    std::normal_distribution<double> normal;
    for (double& stamp : recording.time) stamp += 0.05 / kRate * normal(random);
}

std::vector<Condition> listConditions() {
    const test::SensorNoise white_free{0, 0};
    return {{"all channels"},
            {"displacements alone, 500 Hz", 500, 16, {1e-6, -1}},
            {"displacements alone", kRate, 16, {1e-6, -1}},
            {"accelerations alone", kRate, 16, {-1, 0.01}},
            {"low-passed at 150 Hz", kRate, 16, kSensors, filterAll},
            {"displacements alone, low-passed at 150 Hz", kRate, 16, {1e-6, -1}, filterAll},
            {"1/f noise", kRate, 16, white_free, addSlowNoise},
            {"gains off by up to 1 %", kRate, 16, kSensors, scaleEach},
            {"sensors 1 mm off", kRate, 16, kSensors, displaceEach},
            {"stamps that jitter by 5 %", kRate, 16, kSensors, jitterStamps},
            {"20 octaves per minute", kRate, 20},
            {"60 octaves per minute", kRate, 60},
            {"100 octaves per minute", kRate, 100}};
}

/// `stiffness`, `damping`, `clearance`, `stop stiffness`.
std::string kindOf(const std::string& name) {
    const std::string key = name.substr(name.rfind('.') + 1);
    const bool stop = name.find(".+.") != std::string::npos || name.find(".-.") != std::string::npos;
    return stop && key == "stiffness" ? "stop stiffness" : key;
}

/// Of each kind, RMS over its numbers in standard errors: the mean over the repetitions, and what scatters about it.
std::map<std::string, std::array<double, 2>> sumErrors(const std::map<std::string, std::vector<double>>& errors) {
    std::map<std::string, std::array<double, 3>> sums;
    for (const auto& [name, values] : errors) {
        const Eigen::Map<const Eigen::ArrayXd> e(values.data(), static_cast<Eigen::Index>(values.size()));
        auto& sum = sums[kindOf(name)];
        sum[0] += e.mean() * e.mean();
        sum[1] += (e - e.mean()).square().sum() / static_cast<double>(std::max<Eigen::Index>(1, e.size() - 1));
        sum[2] += 1;
    }
    std::map<std::string, std::array<double, 2>> result;
    for (const auto& [kind, sum] : sums) result[kind] = {std::sqrt(sum[0] / sum[2]), std::sqrt(sum[1] / sum[2])};
    return result;
}

}  // namespace

TEST_CASE("Coverage of the 95 % intervals under every condition", "[.conditions]") {
    const MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const unsigned seed = test::drawSeed();
    const std::vector<Condition> conditions = listConditions();
    const std::size_t which = GENERATE_COPY(range(std::size_t{0}, conditions.size()));
    const Condition& condition = conditions.at(which);
    const char* asked = std::getenv("COVERAGE_CONDITION");
    if (asked != nullptr && condition.name.find(asked) == std::string::npos) return;
    const char* count = std::getenv("COVERAGE_REPETITIONS");
    const int repetitions = count != nullptr ? std::stoi(count) : 60;
    test::SweepSettings sweep;
    sweep.force = {0, 0, 500};
    sweep.octaves_per_minute = condition.octaves_per_minute;
    sweep.sample_rate = condition.rate;
    sweep.steps_per_sample = static_cast<int>(16000 / condition.rate);
    const test::SyntheticRun run = test::simulateSweep(truth, sweep);
    std::map<std::string, std::array<int, 2>> held;     // kind → inside, all
    std::map<std::string, std::vector<double>> errors;  // number → in standard errors
    Random random(seed);
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        const std::uint64_t own = random();
        const MountModel believed = test::perturb(truth, 0.25, own);
        Recording recording = test::record(run, condition.noise, own);
        if (condition.alter) condition.alter(recording, run, random);
        const std::vector<RunMotion> runs{estimateMotion(recording, believed)};
        FitResult fit = fitMount(runs, believed);
        if (updating::hasCoarseContacts(fit, runs))
            fit = updating::refineCoarseContacts(fit, {recording}, believed).value_or(fit);
        for (const auto& p : fit.parameters) {
            const double value = getParameter(truth, p.name);
            errors[p.name].push_back((p.value - value) / p.standard_error);
            for (const auto& key : {kindOf(p.name), std::string("all")}) {
                held[key][0] += p.interval95[0] <= value && value <= p.interval95[1] ? 1 : 0;
                ++held[key][1];
            }
        }
    }
    std::string text = condition.name + ", seed " + std::to_string(seed) + ":";
    for (const auto& [kind, numbers] : held)
        text += " " + kind + " " + std::to_string(numbers[0]) + "/" + std::to_string(numbers[1]);
    for (const auto& [kind, numbers] : sumErrors(errors))
        text += "\n  " + kind + ": errors common to all repetitions " + std::to_string(numbers[0]) +
                " standard errors (RMS), others " + std::to_string(numbers[1]);
    WARN(text);
    CHECK(held["all"][0] >= 0.93 * held["all"][1]);
}

// Few samples of a contact: what the regression has of stops errs by many of its own intervals.
TEST_CASE("Coarse displacements tell stops by the motion between their samples", "[fit]") {
    const MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    test::SweepSettings sweep;
    sweep.force = {0, 0, 500};
    sweep.octaves_per_minute = 16;
    sweep.sample_rate = 500;
    sweep.steps_per_sample = 32;
    const test::SyntheticRun run = test::simulateSweep(truth, sweep);
    const MountModel believed = test::perturb(truth, 0.25, seed);
    const Recording recording = test::record(run, {1e-6, -1}, seed);
    const std::vector<RunMotion> motions{estimateMotion(recording, believed)};
    const FitResult plain = fitMount(motions, believed);
    REQUIRE(updating::hasCoarseContacts(plain, motions));
    const auto answer = updating::refineCoarseContacts(plain, {recording}, believed);
    REQUIRE(answer);
    const FitResult& refined = *answer;
    const auto calcError = [&](const FitResult& fit) {
        double sum = 0;
        int count = 0;
        for (const auto& p : fit.parameters)
            if (kindOf(p.name) == "stop stiffness") {
                const double value = getParameter(truth, p.name);
                sum += std::pow(p.value / value - 1, 2);
                ++count;
            }
        REQUIRE(count > 0);
        return std::sqrt(sum / count);
    };
    INFO("stops err by " << calcError(plain) << " and " << calcError(refined));
    CHECK(calcError(refined) < 0.5 * calcError(plain));
    for (const auto& p : refined.parameters) {
        CAPTURE(p.name, p.value, getParameter(truth, p.name), p.standard_error);
        CHECK(std::abs(p.value - getParameter(truth, p.name)) < 4.5 * p.standard_error);
    }
}

}  // namespace wems::identify
