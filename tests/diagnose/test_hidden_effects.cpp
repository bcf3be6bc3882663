#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "identify/diagnose/diagnose.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/diagnose/draw_until.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/recording/temporary_file.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

hidden::HiddenCase draw(const std::string& kind, std::uint64_t seed, hidden::Sensors sensors = hidden::Sensors::any) {
    hidden::Random random(seed);
    return hidden::drawCase(kind, random, sensors);
}

/// What is believed is exact but for the effect, and says so.
MountModel believeExactly(const hidden::HiddenCase& hidden) {
    MountModel believed = hidden.base;
    for (std::size_t i = 0; i < kToleranceKeys.size(); ++i) believed.tolerances.set(static_cast<ToleranceOf>(i), 0.0);
    return believed;
}

Diagnosis diagnoseCase(const hidden::HiddenCase& hidden, std::uint64_t seed) {
    return diagnose({hidden::recordForward(hidden, 0, seed), hidden::recordForward(hidden, 1, seed)},
                    {hidden::recordForward(hidden, 2, seed)}, believeExactly(hidden));
}

std::vector<std::string> listNamed(const Diagnosis& diagnosis) {
    std::vector<std::string> names;
    for (const auto& cause : diagnosis.causes) {
        if (cause.probability < 0.5) continue;
        names.push_back(cause.cause);
        for (const auto& rival : cause.rivals) names.push_back(rival.cause);
    }
    return names;
}

}  // namespace

TEST_CASE("A random device without hidden effect is left alone", "[diagnose]") {
    test::drawUntilClear([](std::uint64_t seed) -> std::string {
        const auto hidden = draw("none", seed);
        const auto diagnosis = diagnoseCase(hidden, seed);
        if (formatVerdict(diagnosis.verdict) != "nothing_missing" || !listNamed(diagnosis).empty())
            return formatVerdict(diagnosis.verdict);
        // What contact folds in accelerations alone is larger than the floor.
        if (hidden.displacement_noise == 0) return "";
        const bool at_floor = diagnosis.error_after.validation < 1.5 * diagnosis.noise_floor.validation + 0.005;
        return at_floor ? "" : "error above the noise floor";
    });
}

TEST_CASE("A random hidden effect is named or tied", "[diagnose]") {
    test::drawUntilClear([](std::uint64_t seed) {
        auto hidden = draw("single", seed);
        for (std::uint64_t next = seed + 1; hidden.displacement_noise == 0; ++next) hidden = draw("single", next);
        const auto named = listNamed(diagnoseCase(hidden, seed));
        const std::string& cause = hidden.effects[0].cause;
        return std::count(named.begin(), named.end(), cause) > 0 ? "" : cause + " is not named";
    });
}

// With stops reached: their mean push is not measured, and what contact folds in sampled accelerations must not pass
// for an effect. Folding hides some.
TEST_CASE("A random effect on body or elastomer is named or tied, from accelerations alone", "[diagnose]") {
    test::drawUntilClear([](std::uint64_t seed) {
        const std::array<std::string, 3> causes{"mass", "cog_offset", "elastomer_stiffness"};
        const std::string& cause = causes.at(seed % causes.size());
        const auto hidden = draw(cause, seed, hidden::Sensors::accelerations);
        const auto named = listNamed(diagnoseCase(hidden, seed));
        return std::count(named.begin(), named.end(), cause) > 0 ? "" : cause + " is not named";
    });
}

TEST_CASE("A force that no law describes is unexplained, at its axis", "[diagnose]") {
    test::drawUntilClear([](std::uint64_t seed) -> std::string {
        auto hidden = draw("none", seed);
        for (std::uint64_t next = seed + 1; hidden.displacement_noise == 0; ++next) hidden = draw("none", next);
        // A stiffness that comes and goes with a period of its own.
        auto& outside = hidden.outside;
        outside.kind = hidden::OutsideEffect::Kind::periodic_stiffness;
        outside.connection = 1;
        outside.axis = 2;
        outside.frequency = 4;
        outside.size = 0.6 * hidden.base.connections[1].axis[2].stiffness;
        const auto diagnosis = diagnoseCase(hidden, seed);
        const bool placed = formatVerdict(diagnosis.verdict) == "unexplained" && listNamed(diagnosis).empty() &&
                            !diagnosis.unexplained_where.empty() && diagnosis.unexplained_where.front() == "2.z";
        return placed ? "" : formatVerdict(diagnosis.verdict);
    });
}

TEST_CASE("What acted in one identification recording alone is unexplained though the validation is foretold",
          "[diagnose]") {
    test::drawUntilClear([](std::uint64_t seed) -> std::string {
        auto quiet = draw("none", seed);
        for (std::uint64_t next = seed + 1; quiet.displacement_noise == 0; ++next) quiet = draw("none", next);
        auto disturbed = quiet;
        auto& outside = disturbed.outside;
        outside.kind = hidden::OutsideEffect::Kind::disturbance;
        outside.connection = 1;
        outside.axis = 2;
        outside.frequency = 23;
        const AxisLaw& law = quiet.base.connections[1].axis[2];
        outside.size = law.stiffness * law.stops.front().clearance;
        const auto diagnosis =
            diagnose({hidden::recordForward(disturbed, 0, seed), hidden::recordForward(quiet, 1, seed)},
                     {hidden::recordForward(quiet, 2, seed)}, believeExactly(quiet));
        const auto& error = diagnosis.error_after;
        const std::string figures = ", errors " + std::to_string(error.identification) + " and " +
                                    std::to_string(error.validation) + ", band " +
                                    std::to_string(diagnosis.prediction_band.value_or(0));
        return formatVerdict(diagnosis.verdict) == "unexplained" && listNamed(diagnosis).empty()
                   ? ""
                   : formatVerdict(diagnosis.verdict) + figures;
    });
}

TEST_CASE("Another simulator's hidden effects are found", "[diagnose]") {
    const char* folder = std::getenv("WEMS_EXAMPLES");
    if (folder == nullptr) {
        WARN("skipped: WEMS_EXAMPLES is not set");
        return;
    }
    const auto diagnoseExample = [&](const std::string& name) {
        const std::string path = std::string(folder) + "/" + name;
        const auto read = [&](const std::string& run) {
            const test::TemporaryFile unpacked;
            const std::string command = "xz -dc '" + path + "/" + run + ".csv.xz' > '" + unpacked.path() + "'";
            REQUIRE(std::system(command.c_str()) == 0);
            return readRecording(unpacked.path());
        };
        return diagnose({read("run1"), read("run2")}, {read("validate")}, readMountModel(path + "/model.toml"));
    };
    SECTION("a stop too many") {
        const auto diagnosis = diagnoseExample("example_1");
        REQUIRE(diagnosis.causes.size() == 1);
        CHECK(diagnosis.causes[0].cause == "clearance");
        CHECK(listNamed(diagnosis) == std::vector<std::string>{"clearance"});
        CHECK(diagnosis.causes[0].where == std::vector<std::string>{"2.z.+"});
        CHECK_FALSE(std::isfinite(diagnosis.causes[0].parameters.at(0).value));
    }
    SECTION("nothing") {
        const auto diagnosis = diagnoseExample("example_3");
        CHECK(formatVerdict(diagnosis.verdict) == "nothing_missing");
        CHECK(diagnosis.causes.empty());
    }
}
