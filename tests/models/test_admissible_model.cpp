// What a fit found, brought within what a model may hold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "models/mount_model.hpp"
#include "tests/seed.hpp"

using namespace wems;

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Inertia of point masses: a body's by construction.
Matrix3d makeBodyInertia(std::mt19937_64& random, int masses) {
    std::normal_distribution<double> normal(0, 0.1);
    Matrix3d inertia = Matrix3d::Zero();
    for (int i = 0; i < masses; ++i) {
        const Vector3d r(normal(random), normal(random), normal(random));
        inertia += std::abs(normal(random)) * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
    }
    return inertia;
}

bool isAccepted(const Matrix3d& inertia) {
    return findInertiaProblem(calcPrincipalMoments(inertia)).empty();
}

Matrix3d diagonal(double x, double y, double z) {
    return Vector3d(x, y, z).asDiagonal();
}

}  // namespace

TEST_CASE("inertia: that of point masses is a body's, beyond the sum of two moments none is") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    for (int i = 0; i < 200; ++i) CHECK(isAccepted(makeBodyInertia(random, 3 + i % 5)));
    CHECK(isAccepted(diagonal(1, 2, 3)));  // flat
    CHECK_FALSE(isAccepted(diagonal(1, 2, 3.001)));
    CHECK_FALSE(isAccepted(diagonal(0, 2, 2)));
    CHECK_FALSE(isAccepted(diagonal(-1, 2, 2)));
}

TEST_CASE("inertia: limited on the way from the believed one, where bodies end") {
    // 2 + 6 s meets the sum 4 at s = 1/3, and 99 % of the way there is kept.
    CHECK(limitInertia(diagonal(2, 2, 2), diagonal(2, 2, 8)).isApprox(diagonal(2, 2, 3.98), 1e-9));
    // 1 - 2 s meets 0 at s = 1/2.
    CHECK(limitInertia(diagonal(1, 1, 1), diagonal(-1, 1, 1)).isApprox(diagonal(0.01, 1, 1), 1e-9));
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0, 0.2);
    int limited = 0;
    for (int i = 0; i < 500; ++i) {
        const Matrix3d believed = makeBodyInertia(random, 5);
        const Matrix3d drawn = Matrix3d::NullaryExpr([&] { return normal(random); });
        const Matrix3d wanted = believed + 0.5 * (drawn + drawn.transpose());
        const Matrix3d result = limitInertia(believed, wanted);
        CHECK(isAccepted(result));
        if (result == wanted) continue;
        ++limited;
        const double share = (result - believed).norm() / (wanted - believed).norm();
        CHECK(result.isApprox(believed + share * (wanted - believed), 1e-9));
        CHECK(share < 1);
        CHECK_FALSE(isAccepted(believed + 1.001 / 0.99 * share * (wanted - believed)));
        CHECK(calcPrincipalMoments(result)[0] >= 0.0099 * calcPrincipalMoments(believed)[0]);
    }
    CHECK(limited > 100);
}

TEST_CASE("a fitted model holds what a model may hold, and says what was changed") {
    const std::string file = WEMS_SOURCE_DIR "/tests/models/data/every_key.toml";
    const MountModel believed = readMountModel(file);
    const auto reread = [&](const MountModel& model) {
        return parseMountModel(formatMountModel(model, believed.bracket_file), file);
    };
    MountModel model = believed;
    CHECK(makeAdmissible(believed, model).empty());
    CHECK(formatMountModel(model, "") == formatMountModel(believed, ""));

    Connection& connection = model.connections.front();
    AxisLaw& law = connection.axis[2];
    law = AxisLaw();
    law.stiffness = -1e4;
    law.damping = -20;
    law.loss_factor = -0.1;
    law.stops.push_back({Side::negative, 1e-3, 1e5, -0.5});
    law.cubic = -1e9;  // softening: a model may hold it
    law.offset = -1e-4;
    const std::vector<std::pair<const char*, double>> changed{
        {".z.stiffness", -1e4}, {".z.damping", -20}, {".z.loss_factor", -0.1}, {".z.-.dissipation", -0.5}};
    model.body.inertia(2, 2) = 2 * model.body.inertia.trace();
    CHECK_THROWS(reread(model));
    const auto notes = makeAdmissible(believed, model);
    REQUIRE(notes.size() == changed.size() + 1);
    for (std::size_t i = 0; i < changed.size(); ++i)
        CHECK_THAT(notes[i], Catch::StartsWith(connection.name + changed[i].first + " is identified as -"));
    CHECK_THAT(notes.back(), Catch::StartsWith("body.inertia is identified with the principal moments "));
    const AxisLaw written = reread(model).connections.front().axis[2];
    CHECK(written.stiffness == 0);
    CHECK(written.damping == 0);
    CHECK(written.loss_factor == 0);
    CHECK(written.stops.front().dissipation == 0);
    CHECK(written.cubic == -1e9);
    CHECK(written.offset == -1e-4);
    CHECK(makeAdmissible(believed, model).empty());
}
