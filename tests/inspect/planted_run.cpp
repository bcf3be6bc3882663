#include "tests/inspect/planted_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/common/units.hpp"

namespace wems::test {
namespace {

double uniform(std::mt19937& random, double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
}
double logUniform(std::mt19937& random, double from, double to) {
    return std::exp(uniform(random, std::log(from), std::log(to)));
}

double rmsOf(const std::vector<double>& values) {
    double sum = 0, squares = 0;
    for (const double v : values) {
        sum += v;
        squares += v * v;
    }
    const auto n = static_cast<double>(values.size());
    return std::sqrt(squares / n - sum * sum / n / n);
}

void addNoise(std::vector<double>& values, double level, std::mt19937& random) {
    std::normal_distribution<double> normal(0, level);
    for (double& v : values) v += normal(random);
}

/// Samples at which the channel moves by more than a fifth of its largest value within ±`reach` samples.
std::size_t findMovingSample(const std::vector<double>& values, std::size_t reach, std::mt19937& random) {
    double largest = 0;
    for (const double v : values) largest = std::max(largest, std::abs(v));
    for (;;) {
        const auto k = std::uniform_int_distribution<std::size_t>(reach, values.size() - 2 * reach - 2)(random);
        const auto begin = values.begin() + static_cast<std::ptrdiff_t>(k);
        const auto [low, high] = std::minmax_element(begin, begin + static_cast<std::ptrdiff_t>(reach));
        if (*high - *low > 0.2 * largest) return k;
    }
}

}  // namespace

Recording makeSweptRun(std::mt19937& random) {
    const double rate = std::array<double, 3>{500, 1000, 2000}.at(random() % 3);
    const double from = uniform(random, 4, 8), to = uniform(random, 40, 80), duration = uniform(random, 25, 45);
    const double resonance = logUniform(random, 1.5 * from, 0.7 * to), damping = uniform(random, 0.02, 0.1);
    const bool rests = random() % 2 == 0;
    const double still = rests ? 1.0 : 0.0;
    const double bend = uniform(random, 0, 0.3), shift = uniform(random, -0.3, 0.3);
    Recording run;
    run.file = "planted";
    run.first_row = 2;
    std::vector<double> load, z, az, x;
    const auto samples = static_cast<std::size_t>(rate * (duration + 2 * still));
    const double octaves = std::log(to / from) / duration;
    for (std::size_t k = 0; k < samples; ++k) {
        const double t = static_cast<double>(k) / rate - still;
        run.time.push_back(static_cast<double>(k) / rate);
        const bool driven = t >= 0 && t <= duration;
        const double f = from * std::exp(octaves * std::clamp(t, 0.0, duration));
        const double phase = kTwoPi * (f - from) / octaves;
        const double r = f / resonance, real = 1 - r * r, imaginary = 2 * damping * r;
        const double amplitude = driven ? 1e-3 / std::hypot(real, imaginary) : 0;
        const double lag = phase - std::atan2(imaginary, real), omega = kTwoPi * f;
        // Bent near the resonance: harmonics and a shift of the middle grow with the square of the amplitude.
        const double height = amplitude * 2 * damping / 1e-3;
        load.push_back(driven ? 200 * std::sin(phase) : 0);
        z.push_back(amplitude *
                    (std::sin(lag) + bend * height * height * std::sin(3 * lag) + shift * height * height * height));
        az.push_back(-amplitude * omega * omega * (std::sin(lag) + 9 * bend * height * height * std::sin(3 * lag)));
        x.push_back(0.05 * amplitude * std::sin(lag + 1));
    }
    const std::array<std::pair<const char*, std::vector<double>*>, 4> channels = {
        {{"load.fz", &load}, {"mobile.1.z", &z}, {"mobile.1.az", &az}, {"mobile.1.x", &x}}};
    for (const auto& [name, values] : channels) {
        addNoise(*values, rmsOf(*values) * logUniform(random, 3e-5, 1e-3), random);
        run.channels.push_back({name, "", *values, static_cast<int>(run.channels.size()) + 2});
    }
    return run;
}

const char* plantedName(int kind) {
    static constexpr std::array<const char*, kind_count> names = {
        "gap", "repeated stamps", "drop-out", "clipping", "saturation", "hum", "offset", "drift"};
    return names.at(kind);
}

Planted plant(int kind, Recording& run, std::mt19937& random) {
    auto& channel = run.channels[random() % run.channels.size()];
    auto& v = channel.values;
    const double rms = rmsOf(v);
    const auto sizeText = [](double value) { return std::to_string(value); };
    switch (kind) {
        case 0: {
            const auto count = static_cast<std::ptrdiff_t>(logUniform(random, 1, 200));
            const auto at = static_cast<std::ptrdiff_t>(uniform(random, 0.1, 0.8) * static_cast<double>(v.size()));
            run.time.erase(run.time.begin() + at, run.time.begin() + at + count);
            for (auto& other : run.channels)
                other.values.erase(other.values.begin() + at, other.values.begin() + at + count);
            return {FindingKind::gap, "time", std::to_string(count) + " rows"};
        }
        case 1: {
            const auto count = static_cast<std::size_t>(logUniform(random, 1, 20));
            for (std::size_t i = 0; i < count; ++i) {
                const auto at = std::uniform_int_distribution<std::size_t>(1, v.size() - 1)(random);
                run.time[at] = run.time[at - 1];
            }
            return {FindingKind::repeated_time, "time", std::to_string(count) + " rows"};
        }
        case 2: {
            const auto count = static_cast<std::size_t>(logUniform(random, 5, 200));
            const auto at = findMovingSample(v, count, random);
            const double value = random() % 2 == 0 ? 0 : v[at];
            for (std::size_t i = at; i < at + count; ++i) v[i] = value;
            return {FindingKind::drop_out, channel.name, std::to_string(count) + " samples"};
        }
        case 3:
        case 4: {
            const double part = uniform(random, 0.6, 0.95), noise = rms * 1e-4;
            const double limit = part * *std::max_element(v.begin(), v.end());
            for (double& value : v) value = std::min(value, limit);
            if (kind == 4) addNoise(v, noise, random);
            return {kind == 3 ? FindingKind::clipped : FindingKind::saturated, channel.name,
                    "at " + sizeText(part) + " of the largest value"};
        }
        case 5: {
            const double part = logUniform(random, 0.01, 0.1);
            const double f = (random() % 2 == 0 ? 50 : 60) + uniform(random, -0.05, 0.05);
            const double phase = uniform(random, 0, kTwoPi);
            for (std::size_t k = 0; k < v.size(); ++k)
                v[k] += part * rms * std::sqrt(2.0) * std::sin(kTwoPi * f * run.time[k] + phase);
            return {FindingKind::hum, channel.name, sizeText(part) + " of the RMS at " + sizeText(f) + " Hz"};
        }
        case 6: {
            const double part = logUniform(random, 0.05, 0.5) * (random() % 2 == 0 ? 1 : -1);
            for (double& value : v) value += part * rms;
            return {FindingKind::offset, channel.name, sizeText(part) + " of the RMS"};
        }
        default: {
            const double part = logUniform(random, 0.1, 1) * (random() % 2 == 0 ? 1 : -1);
            const double end = run.time.back();
            for (std::size_t k = 0; k < v.size(); ++k) v[k] += part * rms * run.time[k] / end;
            return {FindingKind::drift, channel.name, sizeText(part) + " of the RMS"};
        }
    }
}

}  // namespace wems::test
