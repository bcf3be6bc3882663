// One-axis rigs sampled coarsely: the diagnosis sees load and displacement, some ten samples in a period.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/diagnose/diagnosis.hpp"
#include "identify/rig/rig_problem.hpp"
#include "models/pi.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double kRate = 500;  // Hz, of the recordings
constexpr int kFine = 40;      // steps of the integration for each sample

MountModel makeRig() {
    MountModel model;
    model.body.mass = 2;
    model.body.inertia = Eigen::Matrix3d::Identity();
    model.body.free = {false, false, true, false, false, false};
    model.load_point = LoadPoint{Part::mobile, Eigen::Vector3d::Zero()};
    Connection connection;
    connection.name = "1";
    connection.axis[2].stiffness = 2 * std::pow(kTwoPi * 40, 2);
    connection.axis[2].damping = 2 * 0.02 * std::sqrt(2 * connection.axis[2].stiffness);
    model.connections = {connection};
    return model;
}

/// m q'' + f(q, q') = u(t), by Runge and Kutta at fine steps from rest; internal states of the law follow q.
Recording record(const MountModel& truth, double level, double noise, std::mt19937& generator) {
    const AxisForce force(truth.connections[0].axis[2]);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<double> frequency, phase;
    for (int i = 0; i < 30; ++i) {
        frequency.push_back(5 + 75 * uniform(generator));
        phase.push_back(kTwoPi * uniform(generator));
    }
    const auto load = [&](double t) {
        double sum = 0;
        for (std::size_t i = 0; i < frequency.size(); ++i) sum += std::sin(kTwoPi * frequency[i] * t + phase[i]);
        return level * std::min(1.0, t) * sum / 5;
    };
    const auto states = static_cast<std::size_t>(force.stateCount());
    const int count = static_cast<int>(8 * kRate);
    const double h = 1 / (kRate * kFine);
    std::vector<double> y(2 + states, 0.0);
    const auto rates = [&](double t, const std::vector<double>& at) {
        std::vector<double> rate(at.size());
        rate[0] = at[1];
        rate[1] = (load(t) - force.calcForce(at[0], at[1], t, at.data() + 2)) / truth.body.mass;
        if (states > 0) force.calcStateDerivative(at[0], at[1], at.data() + 2, rate.data() + 2);
        return rate;
    };
    const auto moved = [&](const std::vector<double>& from, const std::vector<double>& rate, double by) {
        std::vector<double> to = from;
        for (std::size_t i = 0; i < to.size(); ++i) to[i] += by * rate[i];
        return to;
    };
    Recording recording;
    recording.file = "drawn";
    Channel displacement, applied;
    displacement.name = "mobile.1.z";
    applied.name = "load.fz";
    double square = 0;
    for (int k = 0; k < count; ++k) {
        recording.time.push_back(k / kRate);
        displacement.values.push_back(y[0]);
        applied.values.push_back(load(k / kRate));
        square += y[0] * y[0];
        for (int i = 0; i < kFine; ++i) {
            const double t = k / kRate + i * h;
            const auto k1 = rates(t, y), k2 = rates(t + h / 2, moved(y, k1, h / 2)),
                       k3 = rates(t + h / 2, moved(y, k2, h / 2)), k4 = rates(t + h, moved(y, k3, h));
            for (std::size_t j = 0; j < y.size(); ++j) y[j] += h / 6 * (k1[j] + 2 * (k2[j] + k3[j]) + k4[j]);
        }
    }
    std::normal_distribution<double> normal(0, noise * std::sqrt(square / count));
    for (double& value : displacement.values) value += normal(generator);
    recording.channels = {displacement, applied};
    return recording;
}

}  // namespace

TEST_CASE("the axis of a rig is the only motion that it can make") {
    MountModel model = makeRig();
    CHECK(findRigAxis(model) == 2);
    model.body.free[0] = true;
    CHECK_FALSE(findRigAxis(model));
    model.body.free = {false, false, false, false, true, false};
    CHECK_FALSE(findRigAxis(model));
}

TEST_CASE("what a coarsely sampled rig hides is found by its free response") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const std::string kinds[] = {"none", "elastomer_stiffness", "cubic_stiffness", "friction", "clearance"};
    for (const std::string& kind : kinds) {
        const MountModel believed = makeRig();
        MountModel truth = believed;
        AxisLaw& law = truth.connections[0].axis[2];
        // Everything within half of its tolerance.
        law.stiffness *= 1 + 0.05 * uniform(generator);
        law.damping *= 1 + 0.15 * uniform(generator);
        const double level = 60, q = level / law.stiffness * 5;
        if (kind == "elastomer_stiffness") law.stiffness *= uniform(generator) > 0 ? 1.3 : 0.75;
        if (kind == "cubic_stiffness") law.cubic = 0.5 * law.stiffness / (q * q);
        if (kind == "friction") law.friction = Friction{0.08 * level, 1e-3, {}};
        if (kind == "clearance") law.stops = {{Side::positive, 0.8 * q, 2 * law.stiffness, 0}};
        const Recording fitted = record(truth, level, 0.005, generator),
                        judge = record(truth, 0.9 * level, 0.005, generator);
        const Diagnosis diagnosis = diagnose({fitted}, {judge}, believed);
        std::string named;
        for (const Cause& cause : diagnosis.causes) named += " " + cause.cause;
        INFO(kind << ": " << formatVerdict(diagnosis.verdict) << named << ", " << diagnosis.error_before.validation
                  << " to " << diagnosis.error_after.validation << ", band " << diagnosis.prediction_band.value_or(0)
                  << ", floor " << diagnosis.noise_floor.validation);
        std::fprintf(stderr, "%s %s%s %g %g\n", kind.c_str(), formatVerdict(diagnosis.verdict).c_str(), named.c_str(), diagnosis.error_before.validation, diagnosis.error_after.validation);
        if (kind == "none") {
            CHECK(diagnosis.verdict == Diagnosis::Verdict::nothing_missing);
            CHECK(diagnosis.causes.empty());
        } else {
            CHECK(diagnosis.verdict == Diagnosis::Verdict::explained);
            REQUIRE_FALSE(diagnosis.causes.empty());
            CHECK(diagnosis.causes.front().cause == kind);
        }
        CHECK(diagnosis.error_after.validation < 0.05);
    }
}
