#include "plugin/sensor_noise.hpp"

#include <random>
#include <string>

namespace wems::plugin {

double getNoiseLevel(const SensorNoise& noise, const ChannelName& name) {
    if (name.part == Part::load) return noise.load;
    if (name.part == Part::base) return noise.base;
    if (name.derivative == Derivative::velocity) return noise.velocity;
    return name.derivative == Derivative::acceleration ? noise.acceleration : noise.displacement;
}

void addNoise(const SensorNoise& noise, std::uint64_t seed, const ChannelName& name, std::vector<double>& values) {
    const double level = getNoiseLevel(noise, name);
    if (!(level > 0)) return;
    std::vector<std::uint32_t> material{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)};
    for (const char letter : formatChannelName(name)) material.push_back(static_cast<unsigned char>(letter));
    std::seed_seq sequence(material.begin(), material.end());
    std::mt19937_64 generator(sequence);
    std::normal_distribution<double> normal(0, level);
    for (double& value : values) value += normal(generator);
}

}  // namespace wems::plugin
