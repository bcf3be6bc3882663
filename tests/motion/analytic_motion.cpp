#include "tests/motion/analytic_motion.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::test {
namespace {}  // namespace

AnalyticMotion::AnalyticMotion(std::mt19937& random, double amplitude, double angle, double lowest, double highest) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 2; ++j) {
            amplitude_(i, j) = (i < 3 ? amplitude : angle) * (0.3 + 0.2 * unit(random));
            frequency_(i, j) = lowest + (highest - lowest) * unit(random);
            phase_(i, j) = kTwoPi * unit(random);
        }
    }
}

double AnalyticMotion::sum(int i, double t, int derivative) const {
    double value = 0;
    for (int j = 0; j < 2; ++j) {
        const double w = kTwoPi * frequency_(i, j);
        value += amplitude_(i, j) * std::pow(w, derivative) * std::sin(w * t + phase_(i, j) + derivative * kPi / 2);
    }
    return value;
}

Eigen::Vector3d AnalyticMotion::p(double t) const {
    return {sum(0, t, 0), sum(1, t, 0), sum(2, t, 0)};
}
Eigen::Vector3d AnalyticMotion::v(double t) const {
    return {sum(0, t, 1), sum(1, t, 1), sum(2, t, 1)};
}
Eigen::Vector3d AnalyticMotion::a(double t) const {
    return {sum(0, t, 2), sum(1, t, 2), sum(2, t, 2)};
}
Eigen::Vector3d AnalyticMotion::angles(double t, int derivative) const {
    return {sum(3, t, derivative), sum(4, t, derivative), sum(5, t, derivative)};
}

Eigen::Matrix3d AnalyticMotion::R(double t) const {
    return rotationFromBryant(angles(t, 0));
}

Eigen::Vector3d AnalyticMotion::w(double t) const {
    return bryantRatesToAngularVelocity(angles(t, 0)) * angles(t, 1);
}

Eigen::Vector3d AnalyticMotion::alpha(double t) const {
    const double h = 2e-5;
    return (8 * (w(t + h) - w(t - h)) - (w(t + 2 * h) - w(t - 2 * h))) / (12 * h);
}

MountModel makeCrossModel() {
    MountModel model;
    model.name = "cross";
    model.body.mass = 8;
    model.body.center_of_gravity = {0, 0, 0.1};
    model.body.inertia = Eigen::Vector3d(0.12, 0.12, 0.03).asDiagonal();
    const Eigen::Vector3d ends[] = {{-0.1, 0, 0}, {0.1, 0, 0}, {0, -0.1, 0}, {0, 0.1, 0}};
    for (int i = 0; i < 4; ++i) {
        Connection connection;
        connection.name = std::to_string(i + 1);
        connection.position = ends[i];
        for (AxisLaw& law : connection.axis) law.stiffness = 1e5;
        model.connections.push_back(connection);
    }
    return model;
}

void addChannels(Recording& recording, const MountModel& model, const std::string& part, const AnalyticMotion& motion,
                 const std::vector<std::string>& quantities, SensorNoise noise, std::mt19937& random) {
    std::normal_distribution<double> normal(0, 1);
    const std::size_t first = recording.channels.size();
    for (const Connection& connection : model.connections) {
        for (const std::string& quantity : quantities) {
            Channel channel;
            channel.name = part + "." + connection.name + "." + quantity;
            recording.channels.push_back(channel);
        }
    }
    for (const double t : recording.time) {
        const Eigen::Matrix3d R = motion.R(t);
        const Eigen::Vector3d p = motion.p(t), v = motion.v(t), w = motion.w(t), a = motion.a(t),
                              alpha = motion.alpha(t);
        std::size_t column = first;
        for (const Connection& connection : model.connections) {
            const Eigen::Vector3d arm = R * connection.position;
            for (const std::string& quantity : quantities) {
                const int axis = quantity.back() - 'x';
                double value = (p + arm - connection.position)[axis], sigma = noise.displacement;
                if (quantity.size() == 2 && quantity.front() == 'v') {
                    value = (v + w.cross(arm))[axis];
                    sigma = 0;
                } else if (quantity.size() == 2) {
                    value = (a + alpha.cross(arm) + w.cross(w.cross(arm)))[axis];
                    sigma = noise.acceleration;
                }
                recording.channels[column++].values.push_back(value + sigma * normal(random));
            }
        }
    }
}

Recording makeEmptyRecording(double sample_rate, double duration) {
    Recording recording;
    recording.file = "synthetic.csv";
    recording.first_row = 2;
    const auto samples = static_cast<int>(std::lround(duration * sample_rate)) + 1;
    for (int k = 0; k < samples; ++k) recording.time.push_back(k / sample_rate);
    return recording;
}

}  // namespace wems::test
