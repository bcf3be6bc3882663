// The same run seen by the ideal layout and by a laboratory's own: the same device comes out, within its intervals.
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/fit/fit.hpp"
#include "models/bryant.hpp"
#include "models/parameter_access.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems::identify {
namespace {

/// Sensors away from the connections, turned, some with one axis: on each part three markers and three accelerometers
/// of three axes, and two accelerometers of one.
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

Recording recordLayout(const test::SyntheticRun& run, const std::vector<SensorPlace>& places,
                       const test::SensorNoise& noise, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> gauss;
    Recording recording;
    recording.file = "laboratory.csv";
    recording.time = run.time;
    recording.first_row = 2;
    for (const SensorPlace& place : places) {
        const bool mobile = place.part == Part::mobile;
        const auto& R = mobile ? run.R_GM : run.R_GF;
        const auto &p = mobile ? run.p_M : run.p_F, &w = mobile ? run.w_M : run.w_F, &a = mobile ? run.a_M : run.a_F,
                   &alpha = mobile ? run.alpha_M : run.alpha_F;
        const Eigen::Matrix3d turned = rotationFromVector(place.rotation);
        const bool single = place.accelerometer && place.name >= "A3";
        for (int axis = single ? 2 : 0; axis < 3; ++axis) {
            Channel channel{place.channelName(axis), "", {}, 0};
            for (std::size_t i = 0; i < run.time.size(); ++i) {
                const auto k = static_cast<Eigen::Index>(i);
                const Eigen::Vector3d r = R[i] * place.position, rate = w.col(k), turn = alpha.col(k);
                const Eigen::Vector3d direction = turned.col(axis);
                const double value = place.accelerometer
                                         ? (R[i] * direction).dot(a.col(k) + turn.cross(r) + rate.cross(rate.cross(r)))
                                         : direction.dot(p.col(k) + r - place.position);
                channel.values.push_back(value + (place.accelerometer ? noise.acceleration : noise.displacement) *
                                                     gauss(generator));
            }
            recording.channels.push_back(std::move(channel));
        }
    }
    return recording;
}

}  // namespace

TEST_CASE("Markers away from the connections and turned sensors identify the same device") {
    const MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const std::uint64_t seed = std::random_device{}();
    CAPTURE(seed);
    const test::SensorNoise noise{1e-6, 0.01};
    test::SweepSettings settings;
    settings.force = {0, 0, 200};
    settings.octaves_per_minute = 16;
    const test::SyntheticRun run = test::simulateSweep(truth, settings);
    MountModel believed = test::perturb(truth, 0.25, seed);
    const FitResult ideal = fitMount({estimateMotion(test::record(run, noise, seed), believed)}, believed);
    believed.places = makeLayout(seed);
    const Recording recording = recordLayout(run, believed.places, noise, seed + 1);
    const FitResult laboratory = fitMount({estimateMotion(recording, believed)}, believed);
    int compared = 0;
    for (const FittedParameter& parameter : laboratory.parameters) {
        if (parameter.name.find("z.stiffness") == std::string::npos) continue;
        const auto same = std::find_if(ideal.parameters.begin(), ideal.parameters.end(),
                                       [&](const FittedParameter& other) { return other.name == parameter.name; });
        REQUIRE(same != ideal.parameters.end());
        ++compared;
        const double own = parameter.interval95[1] - parameter.interval95[0];
        const double other = same->interval95[1] - same->interval95[0];
        CAPTURE(parameter.name, parameter.value, same->value, own, other);
        // Difference of two independent estimates: 95 % intervals of ±1.96 σ each; four σ of the difference.
        CHECK(std::abs(parameter.value - same->value) < 4 * std::hypot(own, other) / 3.92);
        CHECK(parameter.value == Approx(getParameter(truth, parameter.name)).epsilon(0.01));
    }
    CHECK(compared == 4);
}

}  // namespace wems::identify
