#include "tests/plan/plan_case.hpp"

#include <algorithm>
#include <cmath>

#include "tests/diagnose/hidden_device.hpp"
#include "tests/fit/synthetic_run.hpp"

namespace wems::identify::testing {
namespace {

constexpr double kBelief = 0.1;  // by which the believed numbers are off at most

double drawBetween(std::mt19937_64& random, double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

const FittedParameter* findByName(const FitResult& fit, const std::string& name) {
    const auto found = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                    [&](const FittedParameter& parameter) { return parameter.name == name; });
    return found == fit.parameters.end() ? nullptr : &*found;
}

/// The run as an integrator of its own makes it, recorded as planned, with the load.
Recording recordPlanned(const MountModel& truth, const PlannedRun& run, double displacement_noise,
                        std::mt19937_64& random) {
    test::SweepSettings sweep;
    sweep.force = run.level;
    sweep.from = run.from;
    sweep.to = run.to;
    sweep.octaves_per_minute = run.octaves_per_minute;
    sweep.sample_rate = run.sample_rate;
    sweep.steps_per_sample = 8;
    const test::SyntheticRun simulated = test::simulateSweep(truth, sweep);
    Recording recording = test::record(simulated,
                                       {run.sensors.displacement ? displacement_noise : -1,
                                        run.sensors.acceleration ? Rehearsal::kAddedAccelerationNoise : -1},
                                       random());
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd load = simulated.load.row(axis).transpose();
        recording.channels.push_back({std::string("load.f") + "xyz"[axis], "N", {load.begin(), load.end()}, 0});
    }
    return recording;
}

}  // namespace

std::vector<RunMotion> measureAll(const std::vector<Recording>& recordings, const MountModel& model) {
    std::vector<RunMotion> motions;
    for (const Recording& recording : recordings) motions.push_back(estimateMotion(recording, model));
    return motions;
}

PlanCase drawPlanCase(std::mt19937_64& random) {
    PlanCase drawn;
    drawn.truth = makeRandomDevice(random);
    drawn.believed = test::perturb(drawn.truth, kBelief, random());
    for (const ToleranceOf what :
         {ToleranceOf::stiffness, ToleranceOf::damping, ToleranceOf::clearance, ToleranceOf::stop_stiffness})
        drawn.believed.tolerances.set(what, kBelief);
    drawn.noise = std::pow(10.0, drawBetween(random, -6.3, -5.3));  // 0.5 to 5 µm
    PlannedRun run;
    run.octaves_per_minute = std::round(drawBetween(random, 24, 36));  // short runs: 6 to 8 s
    run.sensors.displacement = true;
    const int kind = std::uniform_int_distribution<int>(0, 2)(random);
    double limit = 0;
    if (kind == 0) {
        drawn.kind = "z alone";
        run.level = {0, 0, drawBetween(random, 100, 200)};
        limit = run.level.norm() * drawBetween(random, 1.0, 1.5);
    } else if (kind == 1) {
        drawn.kind = "x or y alone";
        run.level[std::uniform_int_distribution<int>(0, 1)(random)] = drawBetween(random, 50, 100);
        limit = run.level.norm() * drawBetween(random, 1.0, 3.0);
    } else {
        drawn.kind = "too low for stops";
        run.level = Eigen::Vector3d(1, 1, 1) * drawBetween(random, 20, 40);
        limit = drawBetween(random, 300, 500);
    }
    drawn.recordings.push_back(recordPlanned(drawn.truth, run, drawn.noise, random));
    drawn.options.asked.force = limit;
    // The run that is made next takes as long, so that a campaign stays short.
    drawn.options.asked.octaves_per_minute = run.octaves_per_minute;
    return drawn;
}

PlanOutcome tryBestProposal(const PlanCase& drawn, const Plan& plan, std::mt19937_64& random) {
    PlanOutcome outcome;
    if (plan.proposals.empty()) return outcome;
    const Proposal& best = plan.proposals.front();
    outcome.proposed = !best.gain.separates.empty() || best.gain.directions > 0;
    std::vector<Recording> recordings = drawn.recordings;
    recordings.push_back(recordPlanned(drawn.truth, best.candidate, drawn.noise, random));
    const FitResult fit = fitMount(measureAll(recordings, drawn.believed), drawn.believed, drawn.options.fit);
    for (const auto& tie : best.gain.separates) {
        ++outcome.promised;
        outcome.separated += std::all_of(tie.begin(), tie.end(),
                                         [&](const std::string& name) { return findByName(fit, name) != nullptr; });
    }
    for (const PlannedInterval& interval : best.gain.intervals) {
        const FittedParameter* obtained = findByName(fit, interval.name);
        if (obtained == nullptr || !interval.then95) continue;
        (interval.spread < 1.5 ? outcome.width_ratios : outcome.wide_width_ratios)
            .push_back(((*interval.then95)[1] - (*interval.then95)[0]) /
                       (obtained->interval95[1] - obtained->interval95[0]));
    }
    return outcome;
}

}  // namespace wems::identify::testing
