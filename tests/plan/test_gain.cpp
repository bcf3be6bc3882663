// What a further run adds, from two fits written by hand.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/plan/gain.hpp"

namespace wems::identify {
namespace {

MountModel makeTwoSprings() {
    MountModel model;
    for (const char* name : {"1", "2"}) {
        Connection connection;
        connection.name = name;
        connection.axis[0].stiffness = 1000;
        connection.axis[0].stops = {{Side::positive, 1e-3, 1e4, 0}};
        model.connections.push_back(connection);
    }
    return model;
}

/// Known to ± `half_width`.
FittedParameter makeKnown(const std::string& name, double value, double half_width) {
    return {name, "N/m", value, value, half_width / 2, {value - half_width, value + half_width}};
}

FitResult makeSumFit() {
    FitResult fit;
    fit.model = makeTwoSprings();
    UnidentifiedGroup sum;
    sum.names = {"1.x.stiffness", "2.x.stiffness"};
    sum.combination = "1.x.stiffness + 2.x.stiffness";
    UnidentifiedGroup stop;
    stop.names = {"1.x.+.clearance", "1.x.+.stiffness"};
    fit.not_identifiable = {sum, stop};
    fit.parameters = {makeKnown("1.y.stiffness", 500, 40), makeKnown("2.y.stiffness", 500, 5)};
    fit.directions.resize(3);
    fit.directions[0].known = true;
    return fit;
}

}  // namespace

TEST_CASE("A group is separated when all its members are known with a margin") {
    const FitResult now = makeSumFit();
    FitResult then = now;
    then.parameters.push_back(makeKnown("1.x.stiffness", 1010, 100));
    then.directions[1].known = true;
    SECTION("one member alone") {
        const Gain gain = calcGain(now, then);
        CHECK(gain.separates.empty());
        CHECK(gain.becomes_known == std::vector<std::string>{"1.x.stiffness"});
        CHECK(gain.directions == 1);
        CHECK(gain.isWorthwhile());
    }
    SECTION("both") {
        then.parameters.push_back(makeKnown("2.x.stiffness", 1010, 100));
        CHECK(calcGain(now, then).separates == std::vector<std::vector<std::string>>{now.not_identifiable[0].names});
    }
    SECTION("the other one hardly: 15 % is known to a fit, but may be 22 % after another draw of the noise") {
        then.parameters.push_back(makeKnown("2.x.stiffness", 1000, 150));
        CHECK(calcGain(now, then).separates.empty());
    }
}

TEST_CASE("Widths: geometric mean of what narrows, around the values known now") {
    const FitResult now = makeSumFit();
    FitResult then = now;
    then.parameters = {makeKnown("1.y.stiffness", 510, 10), makeKnown("2.y.stiffness", 495, 5),
                       makeKnown("2.x.stiffness", 990, 33)};
    const Gain gain = calcGain(now, then);
    CHECK(gain.width_ratio == Approx(std::sqrt(0.25 * 1.0)));
    REQUIRE(gain.intervals.size() == 6);
    CHECK(gain.intervals[0].name == "1.y.stiffness");
    CHECK((*gain.intervals[0].then95)[0] == Approx(490));
    CHECK((*gain.intervals[0].now95)[1] == Approx(540));
    const PlannedInterval& open = gain.intervals[3];
    CHECK(open.name == "2.x.stiffness");
    CHECK(open.assumed);
    CHECK_FALSE(open.now95);
    CHECK((*open.then95)[1] == Approx(1033));  // around the model's 1000
    CHECK_FALSE(gain.intervals[2].then95);
    CHECK_FALSE(calcGain(now, now).isWorthwhile());
    CHECK(gain.isBetterThan(calcGain(now, now)));
}

TEST_CASE("A common gain: what holds with every device") {
    const FitResult now = makeSumFit();
    FitResult one = now, two = now;
    for (FitResult* then : {&one, &two}) {
        then->parameters.push_back(makeKnown("1.x.stiffness", 1000, 10));
        then->directions[1].known = true;
    }
    one.parameters.push_back(makeKnown("2.x.stiffness", 1000, 20));
    one.directions[2].known = true;
    two.parameters[1] = makeKnown("2.y.stiffness", 500, 2);
    const Gain common = findCommonGain({calcGain(now, one), calcGain(now, two)});
    CHECK(common.separates.empty());
    CHECK(common.becomes_known == std::vector<std::string>{"1.x.stiffness"});
    CHECK(common.directions == 1);
    CHECK(common.width_ratio == Approx(std::pow(2.0 / 5, 0.25)));  // one of two intervals, with one of two devices
    CHECK((*common.intervals[1].then95)[1] - 500 == Approx(std::sqrt(5.0 * 2.0)));
    CHECK(common.intervals[1].spread == Approx(std::sqrt(5.0 / 2.0)));
    CHECK(common.intervals[2].name == "1.x.stiffness");
    CHECK(common.intervals[2].spread == Approx(1));
    CHECK_FALSE(common.intervals[3].then95);  // known with one alone
    SECTION("a device with which the run cannot be made tells nothing") {
        const Gain none = findCommonGain({calcGain(now, one), Gain()});
        CHECK(none.becomes_known.empty());
        CHECK(none.directions == 0);
        for (const PlannedInterval& interval : none.intervals) CHECK_FALSE(interval.then95);
    }
}

}  // namespace wems::identify
