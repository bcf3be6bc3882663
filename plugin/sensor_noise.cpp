#include "plugin/sensor_noise.hpp"

#include <string>

namespace wems::plugin {

double getNoiseLevel(const SensorNoise& noise, const ChannelName& name) {
    if (name.part == Part::load) return noise.load;
    if (name.part == Part::base) return noise.base;
    if (name.derivative == Derivative::velocity) return noise.velocity;
    return name.derivative == Derivative::acceleration ? noise.acceleration : noise.displacement;
}

namespace {

std::mt19937_64 makeGenerator(std::uint64_t seed, const ChannelName& name) {
    std::vector<std::uint32_t> material{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)};
    for (const char letter : formatChannelName(name)) material.push_back(static_cast<unsigned char>(letter));
    std::seed_seq sequence(material.begin(), material.end());
    return std::mt19937_64(sequence);
}

}  // namespace

ChannelNoise::ChannelNoise(const SensorNoise& noise, std::uint64_t seed, const ChannelName& name)
    : present_(getNoiseLevel(noise, name) > 0),
      generator_(makeGenerator(seed, name)),
      normal_(0, present_ ? getNoiseLevel(noise, name) : 1) {}

void ChannelNoise::add(std::vector<double>& values) {
    if (!present_) return;
    for (double& value : values) value += normal_(generator_);
}

}  // namespace wems::plugin
