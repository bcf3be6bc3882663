#include "tests/hidden/sensor_errors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "models/common/units.hpp"

namespace wems::hidden {
namespace {

TriaxErrors drawTriaxes(const SmallErrors& sizes, std::size_t count, Random& random) {
    TriaxErrors errors;
    const Eigen::Index columns = count;
    errors.gain = errors.rotation = errors.place = Eigen::Matrix3Xd::Zero(3, columns);
    for (Eigen::Index i = 0; i < columns; ++i) {
        Eigen::Vector3d axis;
        for (int a = 0; a < 3; ++a) {
            errors.gain(a, i) = 1 + sizes.sensor_gain * drawUniform(random, -1, 1);
            errors.place(a, i) = sizes.sensor_position * drawUniform(random, -1, 1);
            axis[a] = drawUniform(random, -1, 1);
        }
        errors.rotation.col(i) = sizes.sensor_rotation * drawUniform(random, 0, 1) * axis.normalized();
    }
    return errors;
}

}  // namespace

SensorErrors drawSensorErrors(int level, std::size_t count, double time_scale, Random& random) {
    const SmallErrors sizes = makeSmallErrors(level);
    SensorErrors errors;
    errors.mobile_displacement = drawTriaxes(sizes, count, random);
    errors.mobile_acceleration = drawTriaxes(sizes, count, random);
    errors.fixed_displacement = drawTriaxes(sizes, count, random);
    errors.fixed_acceleration = drawTriaxes(sizes, count, random);
    errors.base = drawTriaxes(sizes, 1, random);
    for (double& gain : errors.load_gain) gain = 1 + sizes.load_gain * drawUniform(random, -1, 1);
    errors.load_noise = sizes.load_noise;
    errors.filtered = level > 0;
    errors.pink = sizes.share * drawUniform(random, 0.3, 1);
    const double hum = drawUniform(random, 0.3, 2), mains = drawCoin(random, 0.5) ? 50 : 60;
    if (level < 2) return errors;
    errors.hum = hum;
    errors.hum_frequency = mains;
    errors.coupling = 0.3 / std::max(1.0, time_scale);
    return errors;
}

// H(s) = 1 / ((s² + 2 cos(π/8) s + 1) (s² + 2 cos(3π/8) s + 1)), s = (1 − z⁻¹) / (1 + z⁻¹) / tan(π corner).
AntiAliasFilter::AntiAliasFilter(double corner) {
    const double w = std::tan(kPi * corner);
    for (int i = 0; i < 2; ++i) {
        const double damping = 2 * std::cos((2 * i + 1) * kPi / 8);
        const double a0 = 1 + damping * w + w * w;
        sections_[i] = {w * w / a0, 2 * (w * w - 1) / a0, (1 - damping * w + w * w) / a0};
    }
}

void AntiAliasFilter::apply(Eigen::Ref<Eigen::VectorXd> signal) const {
    for (const Section& section : sections_) {
        double first = 0, second = 0;  // transposed direct form
        for (double& value : signal) {
            const double input = section.b0 * value, output = input + first;
            first = 2 * input - section.a1 * output + second;
            second = input - section.a2 * output;
            value = output;
        }
    }
}

void coupleAc(Eigen::Ref<Eigen::VectorXd> signal, double corner) {
    const double w = std::tan(kPi * corner), keep = (1 - w) / (1 + w), gain = 1 / (1 + w);
    double before = 0, output = 0;
    for (double& value : signal) {
        output = keep * output + gain * (value - before);
        before = value;
        value = output;
    }
}

Eigen::VectorXd drawNoise(const SensorErrors& errors, int finer, double time_scale, double rate, Eigen::Index samples,
                          Random& random) {
    std::normal_distribution<double> normal(0, 1);
    Eigen::VectorXd noise(samples);
    // The filter lets 0.8 / finer of the band through, and 1.026 times that (noise bandwidth of the fourth order).
    const double white = errors.filtered ? std::sqrt(finer / (0.8 * 1.026)) : 1.0;
    for (double& value : noise) value = white * normal(random);
    if (errors.pink > 0) {
        // First-order low-passes a factor of five apart, each of the same variance: 1/f within 1 dB between the
        // corners.
        constexpr double lowest = 0.02, apart = 5;
        Eigen::VectorXd pink = Eigen::VectorXd::Zero(samples);
        double count = 0;
        for (double corner = lowest; corner < 0.2 * rate; corner *= apart, ++count) {
            const double keep = std::exp(-kTwoPi * corner / rate), drive = std::sqrt(1 - keep * keep);
            double state = normal(random);
            for (double& value : pink) {
                value += state;
                state = keep * state + drive * normal(random);
            }
        }
        noise += errors.pink / std::sqrt(count) * pink;
    }
    if (errors.hum > 0) {
        const double phase = drawUniform(random, 0, kTwoPi), amplitude = std::sqrt(2.0) * errors.hum;
        for (Eigen::Index k = 0; k < samples; ++k)
            noise[k] += amplitude *
                        std::sin(kTwoPi * errors.hum_frequency * time_scale * static_cast<double>(k) / rate + phase);
    }
    return noise;
}

}  // namespace wems::hidden
