// Hysteresis in three places that integrate it each in its own way: Simbody, the forward model, and the identification
// along a recorded motion.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "identify/fit/law_history.hpp"
#include "identify/forward/forward_model.hpp"
#include "identify/forward/step_size.hpp"
#include "identify/problem/mount_equation.hpp"
#include "plugin/simulation.hpp"
#include "tests/models/random_values.hpp"
#include "tests/plugin/sample_models.hpp"
#include "tests/seed.hpp"

using namespace wems;

namespace {

constexpr double kInterval = 1e-3;      // s
constexpr double kLoadInterval = 1e-4;  // s: interpolating the load must not be what differs
constexpr int kSamples = 1001;

/// Every axis has hysteresis of its own; one has presliding friction and a Maxwell branch beside it.
MountModel drawModel(test::RandomValues& random) {
    MountModel model = test::makeRigidModel();
    for (Connection& connection : model.connections)
        for (AxisLaw& law : connection.axis) {
            law.damping = 5;
            law.hysteresis =
                Hysteresis{random.number(2, 8), random.number(1e-4, 3e-4), random.number(1, 4), random.number(0.5, 1)};
        }
    model.connections[1].axis[2].friction = Friction{2, 1e-3, 2e4};
    model.connections[1].axis[2].relaxation = Relaxation{0.2, 0.01};
    model.load_point = LoadPoint{Part::mobile, {0.02, 0.01, 0.05}};
    return model;
}

struct Run {
    std::shared_ptr<const Signal> signal = makeLogarithmicSweep(8, 40, 120, {0.1, 0.1});
    Eigen::Vector3d force{30, -20, 60};  // N
};

/// Relative motion (rows 3 i + axis; m, m/s) and force of each axis (N) at the samples.
struct Record {
    Eigen::MatrixXd q{0, kSamples}, v{0, kSamples}, force{0, kSamples};
};

Record simulateSimbody(const MountModel& model, const Run& run) {
    plugin::SimulationSettings settings;
    for (int k = 0; k < kSamples; ++k) settings.times.push_back(k * kInterval);
    settings.accuracy = 1e-9;
    settings.longest_step = 2e-4;
    Record record;
    const auto rows = 3 * static_cast<Eigen::Index>(model.connections.size());
    for (auto* matrix : {&record.q, &record.v, &record.force}) matrix->resize(rows, kSamples);
    Eigen::Index column = 0;
    settings.observer = [&](double, const plugin::DeviceMotion& motion) {
        for (Eigen::Index i = 0; i < rows / 3; ++i) {
            const RelativeMotion& relative = motion.relative[i];
            record.q.block<3, 1>(3 * i, column) = relative.q;
            record.v.block<3, 1>(3 * i, column) = relative.v;
        }
        record.force.col(column++) = motion.force.reshaped();
    };
    plugin::simulate(model, plugin::makeSignalDrive(run.signal, run.force, Eigen::Vector3d::Zero(), true), settings);
    REQUIRE(column == kSamples);
    return record;
}

identify::Drive makeDrive(const Run& run, const MountModel& model, int finer) {
    const identify::TimeGrid grid{0, kInterval, kSamples, finer * identify::chooseStepsPerSample(model, kInterval)};
    std::vector<double> time;
    const auto count = static_cast<Eigen::Index>(kSamples * kInterval / kLoadInterval) + 2;
    Eigen::Matrix3Xd load(3, count);
    for (Eigen::Index k = 0; k < count; ++k) {
        time.push_back(static_cast<double>(k) * kLoadInterval);
        load.col(k) = run.force * run.signal->value(time.back());
    }
    return identify::Drive::makeLoad(time, load, {}, grid);
}

double calcDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
}

/// The motion as a recording without error would give it, at every `step`-th sample.
identify::OpenLoopRun makeOpenRun(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v, int step = 1) {
    identify::OpenLoopRun run;
    const Eigen::Index count = (q.cols() + step - 1) / step;
    run.interval = kInterval * step;
    run.time = Eigen::VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) * run.interval);
    run.q = q(Eigen::all, Eigen::seqN(0, count, step));
    run.v = v(Eigen::all, Eigen::seqN(0, count, step));
    run.quiet = identify::QuietVelocities(run.v);
    return run;
}

Eigen::MatrixXd calcForces(const identify::OpenLoopRun& run, const MountModel& model) {
    Eigen::MatrixXd force(run.q.rows(), run.q.cols());
    for (int row = 0; row < run.q.rows(); ++row)
        force.row(row) =
            identify::calcAxisForce(run, model.connections[row / 3].axis[row % 3], row / 3, row % 3).transpose();
    return force;
}

}  // namespace

TEST_CASE("Simbody, the forward model and the identification agree on hysteresis") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    test::RandomValues random(seed);
    const MountModel model = drawModel(random);
    MountModel without = model;
    for (Connection& connection : without.connections)
        for (AxisLaw& law : connection.axis) law.hysteresis.reset();
    const Run run;
    const Record record = simulateSimbody(model, run);
    const auto simulate = [&](const MountModel& any, int finer) {
        return identify::ForwardModel(any).simulate(makeDrive(run, any, finer)).q;
    };
    const double coarse = calcDifference(simulate(model, 1), record.q),
                 fine = calcDifference(simulate(model, 8), record.q);
    const identify::OpenLoopRun open = makeOpenRun(record.q, record.v);
    const double along = calcDifference(calcForces(open, model), record.force);
    const identify::RelativeHistory relative{record.q.transpose(), record.v.transpose()};
    const std::vector<double> time(open.time.begin(), open.time.end());
    const double history = calcDifference(identify::calcForceHistory(model, relative, time).transpose(), record.force);
    CAPTURE(coarse, fine, along, history);
    CHECK(coarse < 5e-4);
    CHECK(fine < 1e-5);
    CHECK(along < 1e-5);
    CHECK(history < 5e-4);  // Maxwell branches as if the displacement were linear between samples
    // And it matters.
    CHECK(calcDifference(simulate(without, 1), record.q) > 0.1);
    CHECK(calcDifference(calcForces(open, without), record.force) > 0.1);
}

TEST_CASE("along its own motion the equations of a mount with hysteresis leave what the step between samples does") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    test::RandomValues random(seed);
    const MountModel model = drawModel(random);
    const Run drawn;
    const identify::Drive drive = makeDrive(drawn, model, 4);
    const identify::ForwardModel forward(model);
    const identify::Simulation simulation = forward.simulate(drive, identify::Keep::states);
    const auto calcResidual = [&](int step) {
        identify::OpenLoopRun run = makeOpenRun(simulation.q, simulation.q, step);  // calcRelative replaces both
        const int count = run.sampleCount();
        for (identify::SmoothPart* part : {&run.mobile, &run.fixed}) {
            for (auto* matrix : {&part->p, &part->theta, &part->v, &part->w, &part->a, &part->alpha})
                matrix->setZero(3, count);
            part->R.assign(count, Eigen::Matrix3d::Identity());
        }
        Eigen::MatrixXd load(6, count);
        for (int k = 0; k < count; ++k) {
            const identify::ForwardState state = forward.stateAt(simulation, drive, k * step);
            const auto rates = simulation.rates.col(k * step);
            const Eigen::Vector3d w = state.mobile.w_GM, arm = state.mobile.R_GM * model.body.center_of_gravity;
            const Eigen::Vector3d alpha = state.mobile.R_GM * rates.segment<3>(identify::at_angular);
            run.mobile.R[k] = state.mobile.R_GM;
            run.mobile.p.col(k) = state.mobile.p_GM;
            run.mobile.v.col(k) = state.mobile.v_GM;
            run.mobile.w.col(k) = w;
            run.mobile.alpha.col(k) = alpha;
            run.mobile.a.col(k) = rates.segment<3>(identify::at_velocity) - alpha.cross(arm) - w.cross(w.cross(arm));
            const Eigen::Vector3d force = drawn.force * drawn.signal->value(k * step * kInterval);
            load.col(k) << force, (state.mobile.R_GM * model.load_point->position).cross(force);
        }
        identify::calcRelative(model, run.mobile, run.fixed, run.q, run.v);
        const Eigen::MatrixXd residual = identify::calcMountResidual(run, model) - load;
        return residual.topRows(3).norm() / load.topRows(3).norm() +
               residual.bottomRows(3).norm() / load.bottomRows(3).norm();
    };
    const double every = calcResidual(1), second = calcResidual(2), fourth = calcResidual(4);
    CAPTURE(every, second, fourth);
    CHECK(every < 5e-5);
    CHECK(std::log2(fourth / every) / 2 > 3);  // fourth order
}
