#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "identify/updating/update.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kNamed = 0.5;  // contract, section 5: a cause counts as named from this probability on

/// Every number of a model off by a part of its tolerance, as on a bench.
class Bench {
public:
    explicit Bench(unsigned seed) : random(seed) { model = identify::testing::makeRandomDevice(random); }

    MountModel drawTruth() {
        MountModel truth = model;
        truth.body.mass *= within(0.005);
        for (int a = 0; a < 3; ++a) truth.body.center_of_gravity[a] += 1e-3 * part();
        truth.body.inertia *= within(0.05);
        for (auto& connection : truth.connections)
            for (auto& law : connection.axis) {
                law.stiffness *= within(0.10);
                law.damping *= within(0.30);
                for (Stop& stop : law.stops) {
                    stop.clearance *= within(0.05);
                    stop.stiffness *= within(0.15);
                }
            }
        for (auto& mode : truth.bracket) {
            mode.frequency *= within(0.02);
            mode.damping_ratio *= within(0.50);
        }
        return truth;
    }

    Diagnosis diagnose(const MountModel& truth) {
        identify::testing::RunPlan z, xy, all;
        z.force = {0, 0, 150};
        xy.force = {100, 60, 0};
        all.force = {60, 80, 100};
        z.duration = xy.duration = all.duration = 10;
        const std::vector<Recording> runs{record(truth, z), record(truth, xy)};
        updating::ModelUpdate update(updating::TestProblem(runs, {record(truth, all)}, model), model,
                                     updating::Numbers::within_tolerances, {});
        update.select();
        return update.report();
    }

    std::mt19937_64 random;
    MountModel model;

private:
    Recording record(const MountModel& truth, const identify::testing::RunPlan& plan) {
        return identify::testing::recordRun(truth, plan, random);
    }
    /// Half of a tolerance at most.
    double part() { return std::uniform_real_distribution<double>(-0.5, 0.5)(random); }
    double within(double tolerance) { return 1 + tolerance * part(); }
};

}  // namespace

TEST_CASE("A device that is off by less than its tolerances lacks nothing", "[update]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    Bench bench(seed);
    const Diagnosis diagnosis = bench.diagnose(bench.drawTruth());
    for (const Cause& cause : diagnosis.causes) CHECK(cause.probability < kNamed);
    CHECK(diagnosis.verdict == Diagnosis::Verdict::nothing_missing);
    CHECK(diagnosis.error_adjusted.validation < 0.5 * diagnosis.error_before.validation);
    CHECK(diagnosis.adjustments.size() > 10);
}

TEST_CASE("An elastomer beyond its tolerance is named among numbers within theirs", "[update]") {
    const unsigned seed = test::drawSeed() + 2;
    CAPTURE(seed);
    Bench bench(seed);
    MountModel truth = bench.drawTruth();
    // Four tolerances.
    auto& connection = truth.connections[bench.random() % truth.connections.size()];
    connection.axis[2].stiffness *= 1.4;
    const std::string place = connection.name + ".z";
    const Diagnosis diagnosis = bench.diagnose(truth);
    REQUIRE(diagnosis.causes.size() == 1);
    const Cause& cause = diagnosis.causes.front();
    CHECK(cause.cause == "elastomer_stiffness");
    CHECK(cause.probability > kNamed);
    REQUIRE(cause.where == std::vector<std::string>{place});
    const CauseParameter& found = cause.parameters.front();
    CHECK(found.value == Approx(connection.axis[2].stiffness).epsilon(0.05));
    CHECK(found.lower < found.value);
    CHECK(found.upper > found.value);
    CHECK(diagnosis.verdict == Diagnosis::Verdict::explained);
}
