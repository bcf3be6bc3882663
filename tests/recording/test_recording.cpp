#include <catch2/catch.hpp>

#include "models/recording/recording.hpp"

using namespace wems;

TEST_CASE("Channel names are taken apart and put together again") {
    struct Case {
        const char* text;
        Part part;
        const char* connection;
        int axis;
        Derivative derivative;
        Quantity quantity;
    };
    const auto c = GENERATE(values<Case>({
        {"mobile.1.x", Part::mobile, "1", 0, Derivative::displacement, Quantity::length},
        {"mobile.upper left.vy", Part::mobile, "upper left", 1, Derivative::velocity, Quantity::velocity},
        {"fixed.a.b.az", Part::fixed, "a.b", 2, Derivative::acceleration, Quantity::acceleration},
        {"relative.4.z", Part::relative, "4", 2, Derivative::displacement, Quantity::length},
        {"force.4.z", Part::force, "4", 2, Derivative::force, Quantity::force},
        {"load.fx", Part::load, "", 0, Derivative::force, Quantity::force},
        {"base.ay", Part::base, "", 1, Derivative::acceleration, Quantity::acceleration},
    }));
    INFO(c.text);
    const auto name = parseChannelName(c.text);
    REQUIRE(name);
    CHECK(name->part == c.part);
    CHECK(name->connection == c.connection);
    CHECK(name->axis == c.axis);
    CHECK(name->derivative == c.derivative);
    CHECK(findQuantity(*name) == c.quantity);
    CHECK(formatChannelName(*name) == c.text);
}

TEST_CASE("Other names are no channels") {
    const auto* text = GENERATE("", ".", "time", "mobile", "mobile.x", "mobile..x", "mobile.1.", "mobile.1.w",
                                "mobile.1.fx", "mobile.1.xx", "Mobile.1.x", "force.1.ax", "force.1.fx", "load.x",
                                "load.1.fx", "load.az", "base.x", "base.fx", "mobile.1.x [mm]", "mobil.1.x");
    INFO(text);
    CHECK_FALSE(parseChannelName(text));
}

TEST_CASE("A recording finds its channels, connections and sample interval") {
    Recording recording;
    CHECK(recording.sampleInterval() == 0.0);
    recording.time = {1.0, 1.5, 2.0, 2.5};
    for (const auto* name : {"mobile.b.x", "mobile.a.x", "mobile.b.y", "fixed.c.z", "load.fx"})
        recording.channels.push_back({name, "m", {}, 0});
    CHECK(recording.sampleInterval() == 0.5);
    CHECK(recording.connections(Part::mobile) == std::vector<std::string>{"b", "a"});
    CHECK(recording.connections(Part::fixed) == std::vector<std::string>{"c"});
    CHECK(recording.connections(Part::load).empty());
    CHECK(recording.find("mobile.a.x") == &recording.channels[1]);
    CHECK(recording.find("mobile.a.y") == nullptr);
}
