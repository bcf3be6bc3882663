// Devices that runs and tolerances leave possible, by their moments.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/plan/possible_devices.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

constexpr double kTolerance = 0.2;  // of everything, two deviations
constexpr int kDraws = 4000;

/// Two springs along x, of which the runs told the sum, 2200 ± 2 (one deviation), and a stop that they did not reach up
/// to 1.1 mm.
struct Told {
    MountModel model;
    FitResult now;
};

Told makeTold() {
    Told told;
    for (const char* name : {"1", "2"}) {
        Connection connection;
        connection.name = name;
        connection.axis[0].stiffness = 1000;
        told.model.connections.push_back(connection);
    }
    told.model.connections[0].axis[0].stops = {{Side::positive, 1e-3, 1e4, 0}};
    for (const ToleranceOf what : {ToleranceOf::stiffness, ToleranceOf::clearance, ToleranceOf::stop_stiffness})
        told.model.tolerances.set(what, kTolerance);
    told.now.model = told.model;
    told.now.estimate.names = {"1.x.stiffness", "2.x.stiffness"};
    told.now.estimate.values = Eigen::Vector2d(1500, 700);
    const Eigen::Vector2d sum = Eigen::Vector2d(1, 1).normalized(), difference = Eigen::Vector2d(1, -1).normalized();
    told.now.estimate.covariance = 2 * sum * sum.transpose() + 1e8 * difference * difference.transpose();
    told.now.unreached["1.x.+.clearance"] = 1.1e-3;
    return told;
}

}  // namespace

TEST_CASE("Possible devices keep what the runs told and scatter by the tolerances in the rest") {
    const Told told = makeTold();
    const PossibleDevices devices(told.now, told.model);
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    double sum = 0, sum_squares = 0, difference = 0, difference_squares = 0, least = 1;
    for (int k = 0; k < kDraws; ++k) {
        const MountModel device = devices.draw(random);
        const double a = device.connections[0].axis[0].stiffness, b = device.connections[1].axis[0].stiffness;
        sum += (a + b) / kDraws;
        sum_squares += std::pow(a + b - 2200, 2) / kDraws;
        difference += (a - b) / kDraws;
        difference_squares += std::pow(a - b, 2) / kDraws;
        least = std::min(least, device.connections[0].axis[0].stops[0].clearance);
    }
    // Deviations: of the sum as told, 2 N/m (the tolerances alone would leave 141); of the difference 100 √2, about 0.
    CHECK(sum == Approx(2200).margin(0.5));
    CHECK(std::sqrt(sum_squares) == Approx(2).epsilon(0.05));
    CHECK(difference == Approx(0).margin(10));
    CHECK(std::sqrt(difference_squares) == Approx(100 * std::sqrt(2.0)).epsilon(0.05));
    CHECK(least >= 1.1e-3);
    CHECK(least < 1.101e-3);
}

TEST_CASE("A number that is exactly known is the same in every possible device") {
    Told told = makeTold();
    told.model.connections[1].axis_tolerances[0].set(ToleranceOf::stiffness, 0.0);
    const PossibleDevices devices(told.now, told.model);
    std::mt19937_64 random(1);
    const MountModel device = devices.draw(random);
    CHECK(device.connections[1].axis[0].stiffness == Approx(1000).epsilon(1e-6));
    CHECK(device.connections[0].axis[0].stiffness == Approx(1200).margin(10));
}

}  // namespace wems::identify
