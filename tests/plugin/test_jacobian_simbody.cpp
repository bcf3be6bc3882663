// The Jacobian of the mobile part's ends against Simbody's own station Jacobian.
#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <random>

#include "identify/motion/mobile_jacobian.hpp"
#include "models/bryant.hpp"
#include "plugin/simbody.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

SimTK::Vec3 toSimTK(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// A body free in space whose origin is its centre of gravity. Simbody's generalised speeds of a free mobilizer are
/// (ω, v), ours (v, angle rates), ω = N(α, β) rates.
TEST_CASE("Jacobian of the ends is Simbody's station Jacobian through the map of angle rates") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);

    Eigen::Matrix3Xd ends(3, 4);
    ends << -0.1, 0.1, 0, 0, 0, 0, -0.1, 0.1, 0, 0, 0, 0;
    const Eigen::Vector3d center(0.004, -0.003, 0.1415);
    const MobileJacobian jacobian(ends, center);

    SimTK::MultibodySystem system;
    SimTK::SimbodyMatterSubsystem matter(system);
    const SimTK::Body::Rigid rigid(SimTK::MassProperties(8, SimTK::Vec3(0), SimTK::Inertia(0.12, 0.12, 0.03)));
    SimTK::MobilizedBody::Free body(matter.Ground(), rigid);
    SimTK::State state = system.realizeTopology();

    for (int trial = 0; trial < 50; ++trial) {
        Coordinates q;
        for (int i = 0; i < 6; ++i) q[i] = (i < 3 ? 0.01 : 80 * SimTK::Pi / 180) * unit(random);
        SimTK::Rotation R;
        R.setRotationToBodyFixedXYZ(toSimTK(Eigen::Vector3d(q.tail<3>())));
        body.setQToFitTransform(state, SimTK::Transform(R, toSimTK(Eigen::Vector3d(q.head<3>()))));
        system.realize(state, SimTK::Stage::Position);

        const auto J = jacobian.calcJacobian(q);
        const Eigen::Matrix3Xd positions = jacobian.calcPositions(q);
        Eigen::Matrix<double, 6, 6> speeds = Eigen::Matrix<double, 6, 6>::Zero();  // (ω, v) from (v, angle rates)
        speeds.topRightCorner<3, 3>() = bryantRatesToAngularVelocity(q.tail<3>());
        speeds.bottomLeftCorner<3, 3>().setIdentity();
        for (int end = 0; end < 4; ++end) {
            const SimTK::Vec3 station = toSimTK(Eigen::Vector3d(ends.col(end) - center));
            const SimTK::Vec3 location = body.findStationLocationInGround(state, station);
            SimTK::Matrix theirs;
            matter.calcStationJacobian(state, body.getMobilizedBodyIndex(), station, theirs);
            REQUIRE(theirs.nrow() == 3);
            Eigen::Matrix<double, 3, 6> station_jacobian;
            for (int i = 0; i < 3; ++i) {
                REQUIRE(positions(i, end) == Approx(location[i]).margin(1e-14));
                for (int j = 0; j < 6; ++j) station_jacobian(i, j) = theirs(i, j);
            }
            REQUIRE((J.middleRows<3>(3 * end) - station_jacobian * speeds).norm() < 1e-13);
        }
    }
}

}  // namespace
}  // namespace wems::identify
