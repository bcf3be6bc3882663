#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>

#include "identify/updating/test_problem.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;
using namespace wems::identify::updating;

namespace {

/// A rigid motion that sweeps from 5 to 50 Hz in all six directions, each with an amplitude and a phase of its own.
class SweptMotion {
public:
    explicit SweptMotion(std::mt19937_64& random) {
        std::uniform_real_distribution<double> amplitude(0.3, 1), phase(0, kTwoPi);
        for (int i = 0; i < 6; ++i) {
            amplitude_[i] = amplitude(random) * (i < 3 ? 1e-3 : 1e-2);
            phase_[i] = phase(random);
        }
    }
    static constexpr double kDuration = 8;

    /// Of the point r.
    Eigen::Vector3d findPoint(double t, const Eigen::Vector3d& r) const {
        return at(t, 0) + rotationFromVector(at(t, 3)) * r;
    }

    /// By differences of fourth order: 1e-8 of the acceleration at 50 Hz.
    Eigen::Vector3d findAcceleration(double t, const Eigen::Vector3d& r) const {
        constexpr double h = 1e-4;
        return (-findPoint(t - 2 * h, r) / 12 + 4 * findPoint(t - h, r) / 3 - 5 * findPoint(t, r) / 2 +
                4 * findPoint(t + h, r) / 3 - findPoint(t + 2 * h, r) / 12) /
               (h * h);
    }

private:
    Eigen::Vector3d at(double t, int first) const {
        const double octaves = std::log(10.0) / kDuration;
        const double angle = kTwoPi * 5 * (std::exp(octaves * t) - 1) / octaves;
        // From rest to rest; the motion of a device that is driven by forces falls with frequency. Two seconds of rise:
        // what a faster one has below 5 Hz is lost from the recovered rotation, and 1 % of it leaves twice the noise,
        // which bends the misfit too.
        const double edge = std::min({1.0, 0.5 * std::max(0.0, t), 0.5 * std::max(0.0, kDuration - t)});
        const double size = std::exp(-octaves * t) * std::pow(std::sin(0.25 * kTwoPi * edge), 4);
        Eigen::Vector3d value;
        for (int a = 0; a < 3; ++a) value[a] = size * amplitude_[first + a] * std::sin(angle + phase_[first + a]);
        return value;
    }
    double amplitude_[6], phase_[6];
};

/// Accelerations of all connections, in ground axes.
Recording recordAccelerations(const MountModel& model, const SweptMotion& motion, double noise,
                              std::mt19937_64& random) {
    constexpr double rate = 1000;
    std::normal_distribution<double> normal(0, noise);
    Recording recording;
    for (double t = 0; t < SweptMotion::kDuration; t += 1 / rate) recording.time.push_back(t);
    for (const Connection& connection : model.connections)
        for (const int axis : {0, 1, 2}) {
            Channel channel;
            channel.name = "mobile." + connection.name + ".a" + "xyz"[axis];
            channel.unit = "m/s^2";
            for (const double t : recording.time)
                channel.values.push_back(motion.findAcceleration(t, connection.position)[axis] + normal(random));
            recording.channels.push_back(channel);
        }
    return recording;
}

}  // namespace

// A common corner moves all channels as a rigid motion does, so that only what turns with the part shows it: rotations
// of 0.01 rad times accelerations. A column to first order in the motion had a tenth of the curvature.
TEST_CASE("The sensors' quadratic follows AC coupling as far as the part turns", "[linearised run]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    MountModel model = identify::testing::makeRandomDevice(random);
    model.bracket.clear();
    const SweptMotion motion(random);
    const TestProblem problem({recordAccelerations(model, motion, 1e-3, random)}, {}, model);
    const TestView view = problem.view(problem.believedPoint());
    const std::size_t sensors = indexOf(Block::mobile_sensors);
    const BlockInformation& block = view.identification[sensors];
    Eigen::Index column = -1;
    for (std::size_t i = 0; i < problem.table().size(); ++i)
        if (problem.table()[i].name == "mobile.a.corner") column = static_cast<Eigen::Index>(i);
    REQUIRE(column >= 0);
    const double A = block.A(column, column), step = 10 / std::sqrt(A);
    REQUIRE(A > 0);
    const auto misfitAt = [&](double corner) {
        Eigen::VectorXd estimate = Eigen::VectorXd::Zero(problem.deviations().size());
        estimate[column] = corner;
        return problem.misfit(problem.pointAt(estimate, {})).identification[sensors].chi_squared;
    };
    const double ahead = misfitAt(step), here = misfitAt(0), behind = misfitAt(-step);
    CAPTURE(A, step, here / block.count);
    CHECK(ahead + behind - 2 * here == Approx(2 * A * step * step).epsilon(0.1));
}
