#include "tests/forward/forward_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/common/units.hpp"

namespace wems::test {

MountModel makeCross() {
    MountModel model;
    model.name = "cross";
    model.body.mass = 7.0;
    model.body.center_of_gravity = {0.01, -0.02, 0.12};
    model.body.inertia << 0.12, 0.01, -0.005, 0.01, 0.11, 0.004, -0.005, 0.004, 0.04;
    const double reach = 0.1;
    const Eigen::Vector3d ends[] = {{-reach, 0, 0.01}, {reach, 0, -0.01}, {0, -reach, 0}, {0, reach, 0.005}};
    int number = 0;
    for (const Eigen::Vector3d& end : ends) {
        Connection connection;
        connection.name = std::to_string(++number);
        connection.position = end;
        for (auto& law : connection.axis) law.stiffness = 2e4 + 1e3 * number;
        connection.axis[2].stiffness = 9e4 + 5e3 * number;
        model.connections.push_back(connection);
    }
    return model;
}

std::vector<BracketMode> makeBracketModes() {
    BracketMode axial, lateral, tilt;
    axial.frequency = 44;
    axial.damping_ratio = 0.01;
    axial.translation = {0.01, 0, 0.09};
    axial.rotation = {0.2, 0, 0};
    axial.load_translation = {0, 0, 0.09};
    lateral.frequency = 85;
    lateral.damping_ratio = 0.02;
    lateral.translation = {0.25, 0.02, 0};
    lateral.rotation = {0, 0.3, -1.5};
    lateral.load_translation = {0.26, 0.02, 0.01};
    tilt.frequency = 150;
    tilt.damping_ratio = 0.01;
    tilt.translation = {0, 0.02, 0.06};
    tilt.rotation = {0.9, 0.1, 0};
    tilt.load_translation = {0, 0.03, 0.08};
    return {axial, lateral, tilt};
}

MountModel makeOscillator() {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia = Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal();
    model.connections.resize(1);
    model.connections[0].name = "1";
    model.connections[0].axis[2].stiffness = 2e4;
    return model;
}

MountModel makeFreeBody() {
    MountModel model = makeCross();
    for (Connection& connection : model.connections) connection.axis = {};
    return model;
}

identify::TimeGrid makeGrid(double interval, int samples, int steps_per_sample) {
    identify::TimeGrid grid;
    grid.interval = interval;
    grid.samples = samples;
    grid.steps_per_sample = steps_per_sample;
    return grid;
}

std::vector<double> makeTimes(const identify::TimeGrid& grid) {
    std::vector<double> times;
    for (int k = 0; k < grid.samples; ++k) times.push_back(grid.sampleTime(k));
    return times;
}

Eigen::Matrix3Xd makeLoad(const identify::TimeGrid& grid, double amplitude) {
    Eigen::Matrix3Xd load(3, grid.samples);
    for (int k = 0; k < grid.samples; ++k) {
        const double t = grid.sampleTime(k);
        const double start = std::min(1.0, t / 0.1);
        load.col(k) =
            amplitude * start * start *
            Eigen::Vector3d(std::sin(kTwoPi * 14 * t), std::sin(kTwoPi * 23 * t + 1), std::sin(kTwoPi * 31 * t + 2));
    }
    return load;
}

double calcRelativeError(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
}

}  // namespace wems::test
