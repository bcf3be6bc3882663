// Rows of the published tables by the published method, from recordings of an independent integrator.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/paper/single_axis.hpp"
#include "models/common/error.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems::identify {
namespace {

constexpr double axial = 1e5, lateral = 2.6e4, stop_stiffness = 13.2e5;  // N/m

MountModel makeDevice() {
    return readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
}

/// A fast sweep over the same band: a quarter of the samples of the usual one.
Recording sweep(const MountModel& model, const Eigen::Vector3d& force) {
    test::SweepSettings settings;
    settings.force = force;
    settings.octaves_per_minute = 16;
    settings.steps_per_sample = 3;
    return test::record(test::simulateSweep(model, settings), {0, 0}, 1);
}

double valueOf(const SingleAxisResult& result, const std::string& name) {
    const auto found = std::find_if(result.terms.begin(), result.terms.end(),
                                    [&](const SingleAxisTerm& term) { return term.name == name; });
    if (found == result.terms.end()) throw std::runtime_error("no term " + name);
    return found->value;
}

double worstError(const SingleAxisResult& result, const std::vector<std::string>& names, double truth) {
    double worst = 0;
    for (const auto& name : names) worst = std::max(worst, std::abs(valueOf(result, name) / truth - 1));
    return worst;
}

const std::vector<std::string> axial_names{"1.z.stiffness", "2.z.stiffness", "3.z.stiffness", "4.z.stiffness"};
const std::vector<std::string> lateral_names{"1.y.stiffness", "2.y.stiffness", "3.y.stiffness", "4.y.stiffness"};

TEST_CASE("200 N axial: two singular values count, elastomers are within the published 5.5 %") {
    const MountModel device = makeDevice();
    const Recording recording = sweep(device, {0, 0, 200});
    SingleAxisOptions options;
    options.lowest = 5;
    options.highest = 25;
    const SingleAxisResult result = identifySingleAxis(recording, device, options);
    CHECK(result.rank == 2);
    CHECK(result.singular_percent.tail(2).maxCoeff() < 0.6);
    CHECK(worstError(result, axial_names, axial) < 0.055);
    options.damping = true;  // the term that the published equation lacks
    options.highest = 0;
    CHECK(worstError(identifySingleAxis(recording, device, options), axial_names, axial) < 1e-3);
    options.candidates = {2, 0, 1};  // figure 9: lateral forces explain nothing
    options.damping = false;
    for (const SingleAxisTerm& term : identifySingleAxis(recording, device, options).terms) {
        CAPTURE(term.name);
        if (term.name.find(".x.") != std::string::npos) CHECK(term.confidence == Approx(1).margin(1e-3));
        if (term.name == "3.z.stiffness") CHECK(term.confidence > 2);
    }
}

TEST_CASE("One plot 20 % soft: truncation spreads the defect over all four, without warning") {
    MountModel device = makeDevice();
    device.connections[2].axis[2].stiffness *= 0.8;
    SingleAxisOptions options;
    options.damping = true;
    const SingleAxisResult result = identifySingleAxis(sweep(device, {0, 0, 200}), makeDevice(), options);
    const double expected[] = {0.95, 0.95, 0.85, 1.05};
    for (std::size_t i = 0; i < 4; ++i)
        CHECK(valueOf(result, axial_names[i]) == Approx(expected[i] * axial).epsilon(2e-3));
    CHECK(result.residual_fraction < 0.01);
}

TEST_CASE("300 N axial: the stop of 4-z with the elastomers held") {
    const MountModel device = makeDevice();
    const Recording recording = sweep(device, {0, 0, 300});
    SingleAxisOptions options;
    options.hold_elastomers = true;
    CHECK(worstError(identifySingleAxis(recording, device, options), {"4.z.stops.stiffness"}, stop_stiffness) < 0.15);
    options.damping = true;
    const SingleAxisResult damped = identifySingleAxis(recording, device, options);
    CHECK(worstError(damped, {"4.z.stops.stiffness"}, stop_stiffness) < 0.01);
    CHECK(valueOf(damped, "z.damping") == Approx(97.5).epsilon(0.02));
}

TEST_CASE("Oblique: the equation fails with the centre's acceleration, and holds with that of the centre of gravity") {
    const MountModel device = makeDevice();
    const Recording recording = sweep(device, {141.42, 141.42, 0});
    SingleAxisOptions options;
    options.axis = 1;
    CHECK(worstError(identifySingleAxis(recording, device, options), lateral_names, lateral) > 1);
    options.point = AccelerationPoint::center_of_gravity;
    options.damping = true;
    options.keep = 3;
    CHECK(worstError(identifySingleAxis(recording, device, options), lateral_names, lateral) < 0.01);

    // With all forces as candidates the centre's equation holds too, but for the factor 1 + m h²/I, and the axial
    // forces of 3 and 4 enter with opposite signs.
    options.point = AccelerationPoint::marker_centre;
    options.candidates = {0, 1, 2};
    options.keep = 9;
    const SingleAxisResult extended = identifySingleAxis(recording, device, options);
    const double h = device.body.center_of_gravity.z(), inertia = device.body.inertia(0, 0);
    double sum = 0;
    for (const auto& name : lateral_names) sum += valueOf(extended, name);
    CHECK(sum / 4 == Approx(lateral * (1 + device.body.mass * h * h / inertia)).epsilon(0.05));
    CHECK(valueOf(extended, "3.z.stiffness") < 0);
    CHECK(valueOf(extended, "4.z.stiffness") > 0);
}

TEST_CASE("A window without samples and held elastomers without a stop are refused") {
    const MountModel device = makeDevice();
    const Recording recording = sweep(device, {0, 0, 50});
    SingleAxisOptions options;
    options.lowest = 80;
    options.highest = 90;
    CHECK_THROWS_AS(identifySingleAxis(recording, device, options), InputError);
    options.highest = 0;
    options.hold_elastomers = true;
    CHECK_THROWS_WITH(identifySingleAxis(recording, device, options), Catch::Contains("nothing to identify"));
}

}  // namespace
}  // namespace wems::identify
