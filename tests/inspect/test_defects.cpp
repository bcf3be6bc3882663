// Every defect planted at random is found, at its channel; nothing is found where nothing is.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>
#include <random>

#include "identify/inspect/inspection.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/recording/recording_checks.hpp"
#include "tests/inspect/planted_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

std::vector<Finding> findAll(Recording& run) {
    run.findings = repairAndCheck(run);
    std::vector<std::string> notes;
    return findDefects(run, findSweptFrequency(makeUniform(run, notes)));
}

/// A saturated channel whose noise is below its resolution is clipped, and the other way round.
bool isThatKind(FindingKind found, FindingKind planted) {
    const auto isLimit = [](FindingKind kind) {
        return kind == FindingKind::clipped || kind == FindingKind::saturated;
    };
    return found == planted || (isLimit(found) && isLimit(planted));
}

struct Count {
    int planted = 0, found = 0, false_alarms = 0;
    std::vector<std::string> remarks;
};

/// `kind` −1: nothing planted. A dropped row leaves a gap: not a false alarm beside repeated stamps.
void runCase(int kind, std::mt19937& random, Count& count) {
    Recording run = test::makeSweptRun(random);
    test::Planted planted;
    if (kind >= 0) planted = test::plant(kind, run, random);
    ++count.planted;
    bool found = false;
    for (const Finding& finding : findAll(run)) {
        const bool here = kind >= 0 && finding.channel == planted.channel;
        const bool follows = kind == 1 && finding.channel == "time";
        if (here && isThatKind(finding.kind, planted.kind)) {
            found = true;
        } else if (!follows) {
            ++count.false_alarms;
            count.remarks.push_back("false alarm: " + finding.message);
        }
    }
    if (found) ++count.found;
    if (kind >= 0 && !found) count.remarks.push_back("missed: " + planted.channel + ", " + planted.what);
}

}  // namespace

TEST_CASE("Planted defects are found, and nothing else") {
    const unsigned seed = 7;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    Count all;
    for (int kind = -1; kind < test::kind_count; ++kind) runCase(kind, random, all);
    for (const auto& remark : all.remarks) UNSCOPED_INFO(remark);
    // The seed is fixed. A search that finds half of what is planted finds seven or eight of eight in 3.5 of 100 draws.
    CHECK(all.found >= test::kind_count - 1);
    CHECK(all.false_alarms <= 1);
}

TEST_CASE("Impacts of which one is far higher than the others are no limit") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.01);
    std::uniform_real_distribution<double> uniform(0, 1);
    Channel channel{"mobile.1.ay", "m/s^2", {}, 1};
    std::vector<double> time;
    const int highest = 5 + static_cast<int>(20 * uniform(random));
    for (int impact = 0; impact < 30; ++impact) {
        const double height = impact == highest ? 500.0 : 100 * uniform(random);
        const double phase = 6 * uniform(random);
        for (int k = 0; k < 100; ++k) {
            time.push_back(1e-3 * static_cast<double>(time.size()));
            channel.values.push_back(height * std::exp(-0.06 * k) * std::sin(0.9 * k + phase) + noise(random));
        }
    }
    CHECK(findPlateaus(channel, time, 0.01, 1).empty());
}

TEST_CASE("Rates of detection and of false alarms", "[.rates]") {
    const unsigned seed = 20240611;
    std::mt19937 random(seed);
    std::cout << "seed " << seed
              << "\ndefect, planted, found, false alarms (findings at other channels or of other kinds)\n";
    for (int kind = -1; kind < test::kind_count; ++kind) {
        Count count;
        for (int i = 0; i < 50; ++i) runCase(kind, random, count);
        std::cout << (kind < 0 ? "none" : test::plantedName(kind)) << ", " << (kind < 0 ? 0 : count.planted) << ", "
                  << count.found << ", " << count.false_alarms << " in " << 4 * count.planted << " channels\n";
        for (const auto& remark : count.remarks) std::cout << "    " << remark << "\n";
    }
}

}  // namespace wems::identify
