#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/diagnose/diagnosis.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

/// A run into the stops, a run of lower level, and one to validate on.
struct Recordings {
    std::vector<Recording> identification, validation;
};

Recordings recordAll(const MountModel& truth, std::mt19937_64& random) {
    const auto plan = [](double x, double y, double z, bool upward) {
        identify::testing::RunPlan result;
        result.force = {x, y, z};
        result.upward = upward;
        return result;
    };
    Recordings result;
    result.identification = {recordRun(truth, plan(40, 30, 60, true), random),
                             recordRun(truth, plan(20, 40, 250, true), random)};
    result.validation = {recordRun(truth, plan(60, 30, 180, false), random)};
    return result;
}

/// Names and values come back: the parameter of the model that was changed, within its interval (doubled, so that one
/// case in a thousand fails rather than one in twenty).
void checkHidden(const MountModel& model, const std::string& parameter, double value, const std::string& cause,
                 const std::string& reported, std::mt19937_64& random) {
    CAPTURE(parameter, value);
    MountModel truth = model;
    setParameter(truth, parameter, value);
    const auto recordings = recordAll(truth, random);
    const auto diagnosis = diagnose(recordings.identification, recordings.validation, model);
    REQUIRE(diagnosis.causes.size() == 1);
    CHECK(diagnosis.causes[0].cause == cause);
    CHECK(diagnosis.causes[0].probability >= 0.5);
    CHECK(formatVerdict(diagnosis.verdict) == "explained");
    CHECK(diagnosis.error_after.validation < 0.5 * diagnosis.error_before.validation);
    bool found = false;
    for (const auto& p : diagnosis.causes[0].parameters) {
        if (p.name != reported) continue;
        found = true;
        CAPTURE(p.value, p.lower, p.upper);
        CHECK(std::abs(p.value - value) < std::max(p.upper - p.lower, 0.002 * std::abs(value)));
    }
    CHECK(found);
}

}  // namespace

TEST_CASE("Nothing is missing where the model is the truth", "[diagnose]") {
    const auto seed = std::random_device{}();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto model = identify::testing::makeRandomDevice(random);
    const auto recordings = recordAll(model, random);
    const auto diagnosis = diagnose(recordings.identification, recordings.validation, model);
    CHECK(formatVerdict(diagnosis.verdict) == "nothing_missing");
    CHECK(diagnosis.causes.empty());
    // A perfect model leaves the noise and nothing else.
    CHECK(diagnosis.misfit_after == Approx(1.0).margin(0.15));
}

TEST_CASE("A hidden body parameter is found", "[diagnose]") {
    const auto seed = std::random_device{}();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto model = identify::testing::makeRandomDevice(random);
    switch (std::uniform_int_distribution<int>(0, 2)(random)) {
        case 0:
            checkHidden(model, "body.center_of_gravity.z", model.body.center_of_gravity.z() + 0.02, "cog_offset", "z",
                        random);
            break;
        case 1:
            checkHidden(model, "body.mass", 1.06 * model.body.mass, "mass", "mass", random);
            break;
        default:
            checkHidden(model, "body.spin.z", 0.6, "gyroscopic", "z", random);
            break;
    }
}

TEST_CASE("A hidden parameter of a connection is found", "[diagnose]") {
    const auto seed = std::random_device{}();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto model = identify::testing::makeRandomDevice(random);
    switch (std::uniform_int_distribution<int>(0, 2)(random)) {
        case 0:
            checkHidden(model, "2.z.stiffness", 0.85 * model.connections[1].axis[2].stiffness, "elastomer_stiffness",
                        "2.z.stiffness", random);
            break;
        case 1:
            checkHidden(model, "1.z.damping", 3 * model.connections[0].axis[2].damping, "viscous_damping",
                        "1.z.damping", random);
            break;
        default:
            checkHidden(model, "3.z.friction_force", 6, "friction", "3.z.friction_force", random);
            break;
    }
}

TEST_CASE("A faulty channel is found without any force law", "[diagnose]") {
    const auto seed = std::random_device{}();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto model = identify::testing::makeRandomDevice(random);
    auto recordings = recordAll(model, random);
    for (auto* group : {&recordings.identification, &recordings.validation})
        for (auto& recording : *group)
            for (auto& channel : recording.channels)
                if (channel.name == "mobile.2.z")
                    for (double& value : channel.values) value *= 1.05;
    const auto diagnosis = diagnose(recordings.identification, recordings.validation, model);
    REQUIRE(diagnosis.causes.size() == 1);
    CHECK(diagnosis.causes[0].cause == "sensor_gain");
    CHECK(diagnosis.causes[0].where == std::vector<std::string>{"mobile.2.z"});
    CHECK(diagnosis.causes[0].parameters.at(0).value == Approx(1.05).margin(0.003));
}
