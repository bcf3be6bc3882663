#include <catch2/catch.hpp>

#include "models/common/units.hpp"

using wems::findUnitFactor;
using wems::InputError;
using wems::Quantity;

// NIST SP 811, appendix B.8: in = 2.54 cm, g_n = 9.806 65 m/s², lbf = 4.448 222 N, kip = 4.448 222 kN.
TEST_CASE("Units have the factors of the tables") {
    struct Case {
        const char* unit;
        Quantity quantity;
        double factor;
    };
    const auto c = GENERATE(values<Case>({
        {"s", Quantity::time, 1},
        {"ms", Quantity::time, 1e-3},
        {"us", Quantity::time, 1e-6},
        {"m", Quantity::length, 1},
        {"mm", Quantity::length, 1e-3},
        {"um", Quantity::length, 1e-6},
        {"\xC2\xB5m", Quantity::length, 1e-6},
        {"\xCE\xBCm", Quantity::length, 1e-6},
        {"\xB5m", Quantity::length, 1e-6},
        {"in", Quantity::length, 0.0254},
        {"m/s", Quantity::velocity, 1},
        {"mm/s", Quantity::velocity, 1e-3},
        {"in/s", Quantity::velocity, 0.0254},
        {"m/s^2", Quantity::acceleration, 1},
        {"m/s\xC2\xB2", Quantity::acceleration, 1},
        {"mm/s^2", Quantity::acceleration, 1e-3},
        {"g", Quantity::acceleration, 9.80665},
        {"N", Quantity::force, 1},
        {"kN", Quantity::force, 1e3},
        {"lbf", Quantity::force, 4.448222},
        {"lb", Quantity::force, 4.448222},
        {"kip", Quantity::force, 4448.222},
        {"-", Quantity::none, 1},
        {"", Quantity::none, 1},
        {"  mm ", Quantity::length, 1e-3},
    }));
    INFO(c.unit);
    CHECK(findUnitFactor(c.unit, c.quantity, {}) == Approx(c.factor).epsilon(1e-7));
}

TEST_CASE("Another unit is an error that lists those of the quantity") {
    struct Case {
        const char* unit;
        Quantity quantity;
        const char* message;
    };
    const auto c = GENERATE(values<Case>({
        {"furlong", Quantity::length, "'furlong' is not a unit of displacement (accepted: m, mm, um, in)"},
        {"mm", Quantity::time, "'mm' is not a unit of time (accepted: s, ms, us)"},
        {"mm", Quantity::force, "'mm' is not a unit of force (accepted: N, kN, lbf, lb, kip)"},
        {"m", Quantity::velocity, "'m' is not a unit of velocity (accepted: m/s, mm/s, in/s)"},
        {"G", Quantity::acceleration, "'G' is not a unit of acceleration (accepted: m/s^2, mm/s^2, g)"},
        {"", Quantity::length, "'' is not a unit of displacement"},
        {"MM", Quantity::length, "'MM' is not a unit"},
    }));
    CHECK_THROWS_WITH(findUnitFactor(c.unit, c.quantity, {"run.csv", 3, "load.fz"}),
                      Catch::StartsWith(std::string("run.csv:3: load.fz: ") + c.message));
}

TEST_CASE("The SI unit of every quantity has the factor one") {
    for (const auto quantity : {Quantity::time, Quantity::length, Quantity::velocity, Quantity::acceleration,
                                Quantity::force, Quantity::none}) {
        CHECK(findUnitFactor(wems::siUnit(quantity), quantity, {}) == 1.0);
    }
}
