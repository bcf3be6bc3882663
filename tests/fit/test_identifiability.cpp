// What is known of parameters, alone and together, against covariances made for it.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/fit/identifiability.hpp"

namespace wems::identify {
namespace {

struct TwoSprings {
    MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    std::vector<Parameter> parameters{find("1.z.stiffness"), find("2.z.stiffness"), find("1.y.stiffness")};

    Parameter find(const std::string& name) const {
        for (const Parameter& parameter : makeParameters(model, {}))
            if (parameter.name == name) return parameter;
        FAIL(name);
        return {};
    }
};

constexpr double kRoot = 0.70710678118654752;

}  // namespace

TEST_CASE("findDirections: singular values fall, errors are those of the covariance, directions are told by members") {
    const TwoSprings springs;
    // Sum of the first two seen at 100 to 1, their difference at 2, the third at 5.
    Eigen::Matrix3d directions;
    directions << kRoot, kRoot, 0, kRoot, -kRoot, 0, 0, 0, 1;
    const Eigen::Vector3d singular(100, 2, 5);
    const Eigen::MatrixXd information = directions * singular.cwiseAbs2().asDiagonal() * directions.transpose();
    const auto found = findDirections(springs.parameters, information, information.inverse());
    REQUIRE(found.size() == 3);
    const double expected[] = {100, 5, 2};
    for (std::size_t d = 0; d < 3; ++d) {
        CHECK(found[d].singular_value == Approx(expected[d]));
        CHECK(found[d].relative_error == Approx(1 / expected[d]));
        CHECK(found[d].known == (1 / expected[d] < calcTolerance(springs.parameters[0])));
    }
    CHECK(found[0].text == "0.707 1.z.stiffness + 0.707 2.z.stiffness");
    CHECK(found[1].text == "1.y.stiffness");
    CHECK((found[2].text == "0.707 1.z.stiffness - 0.707 2.z.stiffness" ||
           found[2].text == "0.707 2.z.stiffness - 0.707 1.z.stiffness"));
}

TEST_CASE("findIdentifiable: two that only their sum is known of, beside one that is known alone") {
    const TwoSprings springs;
    Eigen::Vector3d scale;
    for (int i = 0; i < 3; ++i) scale[i] = calcScale(springs.model, springs.parameters[i]);
    // Standard errors: sum of the relative values 0.1 %, difference 100 %, the third 1 %.
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    const Eigen::Vector3d sum(kRoot, kRoot, 0), difference(kRoot, -kRoot, 0);
    covariance += 1e-6 * sum * sum.transpose() + 1.0 * difference * difference.transpose();
    covariance(2, 2) = 1e-4;
    const auto halfWidth = [&](const Eigen::VectorXd& a) { return 1.96 * std::sqrt(a.dot(covariance * a)); };
    const Identifiability found = findIdentifiable(springs.model, springs.parameters, scale, covariance, halfWidth);
    CHECK(found.known == std::vector<bool>{false, false, true});
    REQUIRE(found.groups.size() == 1);
    CHECK(found.groups[0].members == std::vector<int>{0, 1});
    REQUIRE(found.groups[0].known.size() == 1);
    const KnownCombination& known = found.groups[0].known[0];
    REQUIRE(known.members == std::vector<int>{0, 1});
    // Both have the same stiffness, so that equal relative errors are equal ones in N/m.
    REQUIRE(scale[0] == scale[1]);
    CHECK(known.factors[0] == Approx(known.factors[1]).epsilon(1e-6));
    CHECK(known.text == "1.z.stiffness + 2.z.stiffness");
    // Springs at opposite ends whose difference is open show it when the mobile part turns.
    CHECK_FALSE(found.groups[0].separate_by.empty());
}

// The sum of four is known to 3 % of itself: a standard error of 0.06 along the unit vector, of 0.12 in the sum of
// four.
TEST_CASE("findIdentifiable: a sum counts as known by its error relative to itself, however many members it has") {
    const TwoSprings springs;
    std::vector<Parameter> parameters;
    for (const char* connection : {"1", "2", "3", "4"})
        parameters.push_back(springs.find(std::string(connection) + ".y.stiffness"));
    Eigen::Vector4d scale;
    for (int i = 0; i < 4; ++i) scale[i] = calcScale(springs.model, parameters[i]);
    const Eigen::Vector4d sum = Eigen::Vector4d::Constant(0.5);
    const Eigen::Matrix4d covariance =
        4 * (Eigen::Matrix4d::Identity() - sum * sum.transpose()) + 0.06 * 0.06 * sum * sum.transpose();
    const auto halfWidth = [&](const Eigen::VectorXd& a) { return 1.96 * std::sqrt(a.dot(covariance * a)); };
    const Identifiability found = findIdentifiable(springs.model, parameters, scale, covariance, halfWidth);
    REQUIRE(found.groups.size() == 1);
    REQUIRE(found.groups[0].known.size() == 1);
    CHECK(found.groups[0].known[0].text == "1.y.stiffness + 2.y.stiffness + 3.y.stiffness + 4.y.stiffness");
}

}  // namespace wems::identify
