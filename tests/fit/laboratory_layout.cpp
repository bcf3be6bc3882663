#include "tests/fit/laboratory_layout.hpp"

#include <Eigen/Geometry>
#include <random>

#include "models/bryant.hpp"

namespace wems::test {

std::vector<SensorPlace> makeLayout(std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<SensorPlace> places;
    const std::vector<Eigen::Vector3d> positions = {
        {0.12, 0.05, 0.20}, {-0.10, 0.09, 0.05}, {0.02, -0.13, 0.12}, {0.06, 0.07, -0.02}, {-0.05, -0.04, 0.18}};
    for (const Part part : {Part::mobile, Part::fixed}) {
        for (const bool accelerometer : {false, true}) {
            for (std::size_t i = 0; i < (accelerometer ? 5U : 3U); ++i) {
                SensorPlace place;
                place.name = (accelerometer ? "A" : "M") + std::to_string(i);
                place.part = part;
                place.accelerometer = accelerometer;
                place.position = positions[i];
                if (part == Part::fixed) place.position.z() *= 0.2;
                place.rotation = {uniform(generator), uniform(generator), uniform(generator)};
                places.push_back(place);
            }
        }
    }
    return places;
}

Recording recordLayout(const SyntheticRun& run, const std::vector<SensorPlace>& places, const SensorNoise& noise,
                       std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> gauss;
    Recording recording;
    recording.file = "laboratory.csv";
    recording.time = run.time;
    recording.first_row = 2;
    for (const SensorPlace& place : places) {
        const bool mobile = place.part == Part::mobile;
        const Eigen::Matrix3d turned = rotationFromVector(place.rotation);
        const bool single = place.accelerometer && place.name >= "A3";
        for (int axis = single ? 2 : 0; axis < 3; ++axis) {
            Channel channel{place.channelName(axis), "", {}, 0};
            for (std::size_t i = 0; i < run.time.size(); ++i) {
                const Eigen::Index k = i;
                const Eigen::Vector3d direction = turned.col(axis);
                const auto& R = (mobile ? run.R_GM : run.R_GF)[i];
                const double value = place.accelerometer
                                         ? (R * direction).dot(run.calcAcceleration(mobile, k, place.position))
                                         : direction.dot(run.calcDisplacement(mobile, k, place.position));
                channel.values.push_back(value + (place.accelerometer ? noise.acceleration : noise.displacement) *
                                                     gauss(generator));
            }
            recording.channels.push_back(std::move(channel));
        }
    }
    return recording;
}

}  // namespace wems::test
