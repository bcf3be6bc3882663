/// @file
/// Reproducible random values for property tests; every test captures its seed.
#pragma once

#include <Eigen/Core>
#include <random>

#include "models/bryant.hpp"
#include "models/mount_forces.hpp"

namespace wems::test {

class RandomValues {
public:
    explicit RandomValues(unsigned seed) : generator_(seed) {}
    double number(double lower, double upper) {
        return std::uniform_real_distribution<double>(lower, upper)(generator_);
    }
    int integer(int lower, int upper) { return std::uniform_int_distribution<int>(lower, upper)(generator_); }
    bool chance() { return integer(0, 1) == 1; }
    Eigen::Vector3d vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
    Eigen::VectorXd vector(int count, double size) {
        Eigen::VectorXd v(count);
        for (double& x : v) x = number(-size, size);
        return v;
    }
    BodyMotion mobileMotion() { return {rotationFromVector(vector(0.5)), vector(0.05), vector(2), vector(1)}; }
    FrameMotion fixedMotion() { return {rotationFromVector(vector(0.5)), vector(0.05), vector(2), vector(1)}; }

    Slider slider() {
        Slider slider{number(0.5, 40), number(2e-5, 1e-3), 0, {}, {}};
        if (chance()) slider.gap = number(1e-4, 2e-3);
        if (chance()) slider.negative_force = number(0.5, 40);
        if (chance()) slider.exponent = number(1, 8);
        return slider;
    }

    /// Through rest, rising or falling, some rows with their slope.
    std::vector<CurveRow> curve() {
        std::vector<CurveRow> rows{{0, 0, {}}};
        for (const double side : {-1.0, 1.0})
            for (int i = integer(1, 3); i > 0; --i) {
                const CurveRow& outer = side < 0 ? rows.front() : rows.back();
                CurveRow row{outer.displacement + side * number(2e-4, 1e-3), outer.force + number(-40, 80), {}};
                if (chance()) row.stiffness = number(-5e4, 5e4);
                rows.insert(side < 0 ? rows.begin() : rows.end(), row);
            }
        return rows;
    }

    /// A law in which every mechanism may occur.
    AxisLaw law() {
        AxisLaw law;
        law.stiffness = number(1e4, 1e5);
        if (chance()) law.damping = number(1, 100);
        if (chance()) law.offset = number(-3e-4, 3e-4);
        if (chance()) law.quadratic = number(-3e6, 3e6);
        if (chance()) law.cubic = number(-1e9, 1e10);
        if (chance()) law.loss_factor = number(0.01, 0.3);
        if (chance()) law.drift = number(-1e-2, 1e-2);
        if (chance()) law.relaxation = Relaxation{number(0.05, 0.5), number(1e-3, 0.1)};
        if (chance()) {
            law.friction = Friction{number(0.5, 20), number(1e-3, 1e-2), {}};
            if (chance()) law.friction->presliding_stiffness = number(1e4, 1e6);
        }
        if (chance()) law.hysteresis = Hysteresis{number(0.5, 40), number(2e-5, 1e-3), number(1, 8), number(0.5, 1)};
        for (int i = chance() ? integer(1, 3) : 0; i > 0; --i)
            law.branches.push_back({number(1e3, 1e5), number(1e-3, 0.3)});
        law.spectrum.push_back({number(0.01, 0.5), number(1e-3, 0.3)});
        for (int i = chance() ? integer(1, 3) : 0; i > 0; --i) law.sliders.push_back(slider());
        if (chance()) law.curve = curve();
        for (int i = integer(0, 2); i > 0; --i) {
            law.stops.push_back({chance() ? Side::positive : Side::negative, number(5e-4, 2e-3), number(1e5, 1e6),
                                 chance() ? number(0.1, 2) : 0.0});
        }
        return law;
    }

    /// Some of the keys that belong to `table`; of all tables if it is empty.
    Tolerances tolerances(std::string_view table) {
        Tolerances result;
        for (std::size_t k = 0; k < kToleranceKeys.size(); ++k)
            if ((table.empty() || table == kToleranceKeys[k].table) && integer(0, 3) == 0)
                result.set(static_cast<ToleranceOf>(k), chance() ? number(0, 0.3) : 0.0);
        return result;
    }

    MountModel model() {
        MountModel model;
        model.name = "random \"quoted\" \\ name";
        if (chance()) model.gravity = vector(10);
        model.body.mass = number(0.5, 20);
        if (chance()) model.body.center_of_gravity = vector(0.2);
        const Eigen::Matrix3d R = rotationFromVector(vector(2));
        const Eigen::Vector3d s(number(0.01, 0.1), number(0.01, 0.1), number(0.01, 0.1));  // second moments
        const Eigen::Vector3d principal(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
        model.body.inertia = principal.asDiagonal();
        if (chance()) {
            const Eigen::Matrix3d turned = R * model.body.inertia * R.transpose();
            model.body.inertia = turned.selfadjointView<Eigen::Lower>();
        }
        if (chance()) model.body.spin = vector(5);
        for (int i = integer(1, 6); i > 0; --i) {
            Connection connection;
            connection.name = "c" + std::to_string(i);
            connection.position = vector(0.2);
            for (AxisLaw& axis : connection.axis) {
                if (integer(0, 3) > 0) axis = law();
            }
            model.connections.push_back(connection);
        }
        if (chance()) {
            model.load = LoadCorrection{{{0.0, number(0.5, 2)}}};
            if (chance()) model.load = LoadCorrection{{{5.0, number(0.5, 2)}, {number(10, 50), 1.0}}};
            if (chance()) model.load->axis_gain = {number(0.9, 1.1), number(0.9, 1.1), 1};
        }
        if (chance()) model.sensors.push_back({"mobile.c1.az", number(0.8, 1.2), number(-1e-3, 1e-3), vector(0.1)});
        if (chance()) drawTolerances(model);
        if (chance()) {
            for (bool& motion : model.body.free) motion = chance();
            model.body.free[integer(0, 5)] = true;
        }
        if (chance()) model.load_point = LoadPoint{chance() ? Part::mobile : Part::fixed, vector(0.2)};
        return model;
    }

private:
    void drawTolerances(MountModel& model) {
        model.tolerances = tolerances("");
        model.body.tolerances = tolerances("body");
        for (Connection& connection : model.connections) {
            connection.tolerances = tolerances("connection");
            for (Tolerances& axis : connection.axis_tolerances) axis = tolerances("axis");
        }
        for (SensorFault& sensor : model.sensors) sensor.tolerances = tolerances("sensor");
    }

    std::mt19937 generator_;
};

}  // namespace wems::test
