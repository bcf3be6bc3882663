// The weight of the weak form, a stop's columns, what is dragged along a cubic, Student's quantile: against integrals
// in closed form, sums by brute force and printed tables.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "identify/fit/equation_of_motion.hpp"
#include "identify/fit/intervals.hpp"
#include "models/common/units.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

double dot(const std::vector<double>& weights, const std::function<double(int)>& f, int half) {
    double sum = 0;
    for (int i = -half; i <= half; ++i) sum += weights[i + half] * f(i);
    return sum;
}

}  // namespace

TEST_CASE("test function: polynomials up to degree five and their derivatives exactly, a sine by its transform") {
    const int knot = GENERATE(1, 3, 8);
    const double h = 2e-3;
    const TestFunction phi(knot, h);
    CHECK(phi.half() <= 3 * knot);
    const double width = knot * h;
    // Moments of the quintic B-spline about its middle: 1, 0, h²/2, 0, 7 h⁴/10 (sum of six uniform variables).
    const double moments[6] = {1, 0, width * width / 2, 0, 0.7 * std::pow(width, 4), 0};
    for (int degree = 0; degree <= 5; ++degree) {
        CAPTURE(knot, degree);
        const double at = std::pow(width, degree);
        const auto power = [&](int i) { return std::pow(i * h, degree); };
        CHECK(dot(phi.value(), power, phi.half()) == Approx(moments[degree]).margin(1e-12 * at));
        // −∫ φ' s^n = n ∫ φ s^(n−1); the taps hold φ'.
        const double first = degree == 0 ? 0 : degree * moments[degree - 1];
        const double second = degree < 2 ? 0 : degree * (degree - 1) * moments[degree - 2];
        CHECK(-dot(phi.first(), power, phi.half()) == Approx(first).margin(1e-10 * at / width));
        CHECK(dot(phi.second(), power, phi.half()) == Approx(second).margin(1e-9 * at / width / width));
    }
    for (const double f : {0.1 / width, 0.2 / width, 0.5 / width}) {
        const auto cosine = [&](int i) { return std::cos(kTwoPi * f * i * h); };
        const double x = kPi * f * width, expected = std::pow(std::sin(x) / x, 6);
        CHECK(phi.response(f) == Approx(expected));
        // What the sums add are the images about the multiples of the sampling rate.
        if (knot > 1) CHECK(dot(phi.value(), cosine, phi.half()) == Approx(expected).epsilon(1e-3));
    }
    CHECK(phi.response(0) == Approx(1));
    for (const int samples : {2 * phi.half() + 1, 500}) {
        const int outputs = phi.outputCount(samples);
        CHECK((outputs - 1) * phi.stride() + 2 * phi.half() + 1 <= samples);
        CHECK(outputs * phi.stride() + 2 * phi.half() + 1 > samples);
    }
    CHECK(phi.outputCount(2 * phi.half()) <= 0);
}

TEST_CASE("Student's 95 % quantile as tables print it") {
    const std::pair<double, double> printed[] = {{1, 12.706}, {2, 4.303},  {5, 2.571},
                                                 {10, 2.228}, {30, 2.042}, {1e6, 1.960}};
    for (const auto& [degrees, quantile] : printed) CHECK(studentQuantile95(degrees) == Approx(quantile).margin(6e-4));
    CHECK(studentQuantile95(0.5) == std::numeric_limits<double>::infinity());
}

TEST_CASE("stop column: force and slope of every sample, averaged by brute force, and products with means removed") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<> normal;
    const TestFunction phi(4, 1e-3);
    const int samples = 400, outputs = phi.outputCount(samples);
    AxisHistory history;
    history.pattern.resize(6, samples);
    for (double& value : history.pattern.reshaped()) value = normal(random);
    for (int k = 0; k < samples; ++k) {
        history.sample.push_back(k);
        history.q.push_back(2e-3 * std::sin(0.07 * k));
        history.v.push_back(0.14 * std::cos(0.07 * k));
    }
    const double offset = 2e-4;
    const Stop stops[2] = {{Side::positive, 1e-3, 0, 3.0}, {Side::negative, 1.5e-3, 0, 0.0}};
    // Outputs in columns, dense; value and its central difference to the clearance, which is exact: it is linear.
    const auto force = [&](const Stop& stop, double clearance, std::size_t k) {
        const double side = stop.side == Side::positive ? 1 : -1;
        const double depth = side * (history.q[k] + offset) - clearance;
        return depth > 0 ? side * depth * std::max(0.0, 1 + stop.dissipation * side * history.v[k]) : 0.0;
    };
    const auto average = [&](const std::function<double(std::size_t)>& f) {
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6, outputs);
        for (int n = 0; n < outputs; ++n)
            for (int i = 0; i <= 2 * phi.half(); ++i) {
                const int k = n * phi.stride() + i;
                dense.col(n) += phi.value()[i] * f(k) * history.pattern.col(k);
            }
        return dense;
    };
    Eigen::MatrixXd values[2], slopes[2];
    StopColumn columns[2];
    for (int s = 0; s < 2; ++s) {
        const Stop& stop = stops[s];
        columns[s] = makeStopColumn(history, phi, outputs, stop, offset);
        values[s] = average([&](std::size_t k) { return force(stop, stop.clearance, k); });
        const double step = 1e-9;
        slopes[s] = average([&](std::size_t k) {
            return force(stop, stop.clearance, k) > 0 || force(stop, stop.clearance, k) < 0
                       ? (force(stop, stop.clearance + step, k) - force(stop, stop.clearance - step, k)) / (2 * step)
                       : 0.0;
        });
        Eigen::MatrixXd found = Eigen::MatrixXd::Zero(6, outputs), slope = found;
        for (std::size_t i = 0; i < columns[s].output.size(); ++i) {
            found.col(columns[s].output[i]) = columns[s].value.col(i);
            slope.col(columns[s].output[i]) = columns[s].slope.col(i);
        }
        CAPTURE(s);
        CHECK((found - values[s]).cwiseAbs().maxCoeff() < 1e-12 * values[s].cwiseAbs().maxCoeff());
        CHECK((slope - slopes[s]).cwiseAbs().maxCoeff() < 1e-4 * slopes[s].cwiseAbs().maxCoeff());
        CHECK((columns[s].value_mean - values[s].rowwise().mean()).norm() < 1e-12 * values[s].norm());
    }
    const auto centred = [](const Eigen::MatrixXd& dense) { return (dense.colwise() - dense.rowwise().mean()).eval(); };
    const StopProducts products = multiply(columns[0], columns[1], outputs);
    const double size = values[0].norm() * values[1].norm(), steep = slopes[0].norm() * slopes[1].norm();
    CHECK(products.value_value ==
          Approx(centred(values[0]).cwiseProduct(centred(values[1])).sum()).margin(1e-12 * size));
    CHECK(products.slope_slope ==
          Approx(centred(slopes[0]).cwiseProduct(centred(slopes[1])).sum()).margin(1e-4 * steep));
    Matrix6d turn;
    for (double& value : turn.reshaped()) value = normal(random);
    StopColumn turned = columns[0];
    transform(turned, turn);
    CHECK((turned.value - turn * columns[0].value).norm() < 1e-12 * turned.value.norm());
    CHECK((turned.slope_mean - turn * columns[0].slope_mean).norm() < 1e-12 * turned.slope_mean.norm() + 1e-30);
}
