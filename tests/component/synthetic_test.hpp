/// @file
/// Recordings of an element whose law is known, for tests of the single-connection methods.
#pragma once

#include <cmath>
#include <functional>
#include <random>

#include "models/recording/recording.hpp"

namespace wems::test {

struct SyntheticTest {
    double amplitude = 3e-3;    ///< m, of the largest swing
    double duration = 5;        ///< s
    double sample_rate = 2000;  ///< Hz
    double noise = 0;           ///< N, standard deviation of the force's noise
    double correlation = 0.95;  ///< of the noise between neighbouring samples (first-order autoregressive)
};

/// Three sines of incommensurate frequencies, so that the state (q, v) fills its plane. `law` is called in order of
/// time and may keep a memory.
inline Recording makeSyntheticTest(const std::function<double(double q, double v)>& law, const SyntheticTest& test,
                                   unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0.0, 6.28);
    const double phases[] = {phase(generator), phase(generator), phase(generator)};
    const double frequencies[] = {2.0, 3.3, 4.7}, shares[] = {0.6, 0.3, 0.2};
    Recording recording;
    recording.file = "synthetic";
    Channel q{"relative.1.z", "m", {}, 2}, v{"relative.1.vz", "m/s", {}, 3}, f{"force.1.z", "N", {}, 4};
    double noise = test.noise * normal(generator);
    const auto count = static_cast<int>(test.duration * test.sample_rate);
    for (int i = 0; i < count; ++i) {
        const double t = i / test.sample_rate;
        double displacement = 0, velocity = 0;
        for (int k = 0; k < 3; ++k) {
            const double w = 2 * 3.14159265358979 * frequencies[k], a = test.amplitude * shares[k];
            displacement += a * std::sin(w * t + phases[k]);
            velocity += a * w * std::cos(w * t + phases[k]);
        }
        recording.time.push_back(t);
        q.values.push_back(displacement);
        v.values.push_back(velocity);
        f.values.push_back(law(displacement, velocity) + noise);
        noise = test.correlation * noise +
                std::sqrt(1 - test.correlation * test.correlation) * test.noise * normal(generator);
    }
    recording.channels = {q, v, f};
    return recording;
}

}  // namespace wems::test
