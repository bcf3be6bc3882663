// The benchmark beam: natural frequencies and static deflection in closed form, and the spring back from its recording.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/paper/beam_tip.hpp"
#include "models/beam/beam.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"
#include "tests/cli/run_program.hpp"

namespace wems {
namespace {

double bendingStiffness(const Beam& beam) {
    return beam.modulus * beam.width * std::pow(beam.thickness, 3) / 12;
}

TEST_CASE("Natural frequencies of the clamped-free beam are those of Euler and Bernoulli") {
    const Beam beam;
    const double mass_per_length = beam.density * beam.width * beam.thickness;
    const Eigen::VectorXd frequencies = findBeamFrequencies(beam);
    const double roots[] = {1.875104068711961, 4.694091132974175, 7.854757438237613};  // cos x cosh x = -1
    for (int n = 0; n < 3; ++n) {
        const double expected = std::pow(roots[n] / beam.length, 2) *
                                std::sqrt(bendingStiffness(beam) / mass_per_length) / (2 * 3.141592653589793);
        CAPTURE(n);
        CHECK(frequencies(n) == Approx(expected).epsilon(1e-3));
    }
}

TEST_CASE("Far below its first frequency the beam follows a slow force statically") {
    Beam beam;
    beam.tip_cubic = 0;
    BeamRun run;
    run.force = 10;
    run.sample_rate = 1000;
    const Recording recording = simulateBeam(beam, *makeDwell(1, 3, {0.5, 0}), run);
    const Channel* tip = recording.find("mobile.10.z");
    REQUIRE(tip != nullptr);
    double largest = 0;
    for (std::size_t k = 1000; k < tip->values.size(); ++k) largest = std::max(largest, std::abs(tip->values[k]));
    const double a = beam.length * beam.load_node / beam.elements;
    const double expected = run.force * a * a * (3 * beam.length - a) / (6 * bendingStiffness(beam));
    CHECK(largest == Approx(expected).epsilon(0.01));
}

TEST_CASE("Read back from CSV, the complete tip equation gives the spring within 1 %, the truncated one does not") {
    const Beam beam;
    BeamRun run;
    run.force = 10;
    run.sample_rate = 2000;
    run.steps_per_sample = 2;
    const test::TemporaryDirectory folder;
    const std::string file = folder.path() + "/beam.csv";
    writeCsv(simulateBeam(beam, *makeLogarithmicSweep(15, 40, 60), run), file, 13);
    const identify::BeamTip tip = identify::identifyBeamTip(readRecording(file), beam);
    CHECK(tip.complete.cubic == Approx(beam.tip_cubic).epsilon(0.01));
    CHECK(tip.complete.stiffness == Approx(1).epsilon(0.01));
    CHECK(tip.complete.damping == Approx(beam.stiffness_damping).epsilon(0.01));
    CHECK(tip.truncated.cubic > 0);  // hardening: the shape
    CHECK(std::abs(tip.truncated.cubic / beam.tip_cubic - 1) > 0.5);
    CHECK(tip.truncated.residual_fraction > 10 * tip.complete.residual_fraction);
}

TEST_CASE("A recording without the rotations is named as such") {
    Recording recording;
    recording.file = "beam.csv";
    recording.time = {0, 1, 2, 3};
    for (const char* name : {"mobile.9.z", "mobile.10.z", "mobile.9.az", "mobile.10.az"})
        recording.channels.push_back({name, "m", {0, 1, 2, 3}, 0});
    CHECK_THROWS_WITH(identify::identifyBeamTip(recording, Beam{}), Catch::Contains("this channel is missing"));
}

}  // namespace
}  // namespace wems
