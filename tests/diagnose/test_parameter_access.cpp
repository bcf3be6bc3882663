#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "models/axis_numbers.hpp"
#include "models/common/error.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"

using namespace wems;

TEST_CASE("What is set is what is read, and nothing else changes", "[parameter]") {
    std::mt19937_64 random(20);
    const auto model = identify::testing::makeRandomDevice(random);
    std::vector<std::string> names = {"1.z.stiffness_ratio",
                                      "1.z.time_constant",
                                      "2.x.friction_force",
                                      "2.x.hysteresis_force",
                                      "2.x.yield_displacement",
                                      "2.x.exponent",
                                      "2.x.shape",
                                      "1.z.+.clearance",
                                      "1.z.-.stiffness",
                                      "1.z.dissipation",
                                      "body.mass",
                                      "body.center_of_gravity.y",
                                      "body.inertia.Ixz",
                                      "body.spin.z",
                                      "2.frequency",
                                      "6.damping_ratio",
                                      "3.uy",
                                      "3.rz",
                                      "4.load.ux",
                                      "5.base.uz",
                                      "load.gain",
                                      "load.gain.y",
                                      "mobile.1.az.gain",
                                      "mobile.1.z.delay",
                                      "fixed.2.ry"};
    for (const auto& number : kAxisNumbers) names.push_back(std::string("1.z.") + number.key);
    for (const auto& name : names) {
        CAPTURE(name);
        MountModel changed = model;
        const double value = getParameter(model, name) + 0.25 * parameterScale(model, name);
        setParameter(changed, name, value);
        CHECK(getParameter(changed, name) == value);
        CHECK_FALSE(parameterUnit(name).empty());
        for (const auto& other : names) {
            if (other == name) continue;
            CAPTURE(other);
            CHECK(getParameter(changed, other) == getParameter(model, other));
        }
    }
}

TEST_CASE("A stop is removed and added by its clearance", "[parameter]") {
    std::mt19937_64 random(21);
    auto model = identify::testing::makeRandomDevice(random);
    setParameter(model, "1.z.+.clearance", INFINITY);
    CHECK(model.connections[0].axis[2].stops.size() == 1);
    CHECK(std::isinf(getParameter(model, "1.z.+.clearance")));
    setParameter(model, "1.z.+.clearance", 1e-3);
    REQUIRE(model.connections[0].axis[2].stops.size() == 2);
    // The stiffness of its neighbours.
    CHECK(getParameter(model, "1.z.+.stiffness") == getParameter(model, "1.z.-.stiffness"));
}

TEST_CASE("Names that do not exist are refused with the name", "[parameter]") {
    std::mt19937_64 random(22);
    const auto model = identify::testing::makeRandomDevice(random);
    for (const char* name : {"1.z.stifness", "9.z.stiffness", "body.weight", "99.frequency", "1.w.stiffness", "",
                             "mobile.1.az.offset", "body.inertia.Iyx", "2.load.rx", "2.ua", "9.ux"}) {
        CAPTURE(name);
        CHECK_THROWS_AS(getParameter(model, name), InputError);
    }
}
