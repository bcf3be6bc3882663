// TestProblem: what errors of sensors make of the runs, and of the noise that they show.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/updating/test_problem.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify::updating {
namespace {

// What passes for noise at first gives the priors weight that they do not have: after one pass 0.87 to 1.23 of the
// noise's amplitude stood, after two 0.87 to 1.16, and a third changed nothing (six devices).
constexpr int kNoisePasses = 2;

/// What taking gains off the channels of a group makes of their noise's mean power.
double calcNoiseScale(const SensorGroup& group, const SensorErrors& errors) {
    if (group.channels.empty()) return 1;
    double square = 0;
    for (const int c : group.channels) square += std::pow(1 + errors.gain[c], -2);
    return square / static_cast<double>(group.channels.size());
}

}  // namespace

void TestProblem::calibrateNoise() {
    const auto isSine = [](const TestRun& run) { return run.swept.is_sine; };
    ColumnSet columns = catalogue_.columns;
    columns.wantNone();
    std::vector<Direction> priors;
    for (std::size_t i = 0; i < table_.size(); ++i) {
        const Unknown& row = table_[i];
        if (!isOfSensor(row.kind)) continue;
        columns.wanted[i] = 1;
        priors.push_back({{static_cast<int>(i), row.deviation > 0 ? row.deviation : row.reach}});
    }
    if (priors.empty() || std::all_of(runs().begin(), runs().end(), isSine)) return;
    for (int pass = 0; pass < kNoisePasses; ++pass) {
        const TestView view = this->view(believedPoint(), columns, {});
        Information sensors = view.identification;
        add(sensors, view.validation);
        sensors[indexOf(Block::mount)] = sensors[indexOf(Block::bracket)] = {};
        const BlockInformation known = combine(sensors, {}, reaches());
        if (known.empty()) return;  // no sensor can be told by the others
        const Evidence evidence(known, priors, {});
        const TestPoint point = pointAt(evidence.solve({}).mean, {});
        std::vector<TestRun> measured = runs();
        runParallel(measured.size(), [&](std::size_t r) {
            if (isSine(measured[r])) return;
            const TestRun corrected = correctRun(measured[r], point);
            measured[r].noise = estimateChannelNoise(corrected, layout_);
            for (std::size_t g = 0; g < layout_.groups.size(); ++g)
                measured[r].noise[g].scale(1 / calcNoiseScale(layout_.groups[g], point.state.sensors));
        });
        runs_ = std::make_shared<const std::vector<TestRun>>(std::move(measured));
    }
    forgetCorrected();
}

DriveNoise TestProblem::calcDriveNoise(std::size_t index) const {
    const TestRun& run = runs()[index];
    DriveNoise noise;
    noise.lowest = run.band.lowest;
    noise.highest = run.band.highest;
    if (run.motion.load.cols() > 0) noise.load = run.load_noise;
    const PartMotion& fixed = run.motion.fixed;
    for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
        if (layout_.groups[g].part != Part::fixed) continue;
        const auto ofMotion = [&](const Matrix6& covariance) {
            NoiseDensity density = run.noise[g];
            density.scale(covariance.topLeftCorner<3, 3>().trace() / 3);
            return density;
        };
        const bool displacement = layout_.groups[g].derivative == Derivative::displacement;
        if (displacement && fixed.displacement_measured) noise.displacement = ofMotion(fixed.displacement_covariance);
        if (!displacement && fixed.acceleration_measured) noise.acceleration = ofMotion(fixed.acceleration_covariance);
        if (!displacement && run.motion.fixed_source == FixedSource::base)
            noise.base = noise.acceleration = run.noise[g];
    }
    return noise;
}

TestProblem::ExactRun TestProblem::calcExactRun(std::size_t index, const TestPoint& point) const {
    TestRun exact = point.state.sensors.isZero() ? runs()[index] : correctRun(runs()[index], point);
    const Eigen::MatrixXd relative = calcMeasuredRelative(exact.recording, exact.motion, believed_);
    return {std::move(exact.motion), relative};
}

TestRun TestProblem::correctRun(const TestRun& run, const TestPoint& point) const {
    TestRun corrected = run;
    corrected.recording = correctSensors(run.recording, layout_, point.state.sensors, run.band.lowest);
    corrected.motion = estimateMotion(corrected.recording, believed_, ContactEdges::filtered);
    // What a place makes follows from the motion without it, to second order in the places.
    if (placeSensors(corrected.recording, layout_, point.state.sensors, corrected.motion))
        corrected.motion = estimateMotion(corrected.recording, believed_, ContactEdges::filtered);
    // Taking a gain off a channel takes it off the channel's noise.
    for (std::size_t g = 0; g < layout_.groups.size(); ++g)
        corrected.noise[g].scale(calcNoiseScale(layout_.groups[g], point.state.sensors));
    return corrected;
}

std::shared_ptr<const std::vector<TestRun>> TestProblem::correctRuns(const TestPoint& point) const {
    const SensorErrors& errors = point.state.sensors;
    if (errors.isZero()) return runs_;
    if (!corrected_ || !(corrected_->errors == errors)) {
        corrected_.reset();
        std::vector<TestRun> corrected(runs().size());
        runParallel(runs().size(), [&](std::size_t r) { corrected[r] = correctRun(runs()[r], point); });
        corrected_ = CorrectedRuns{errors, std::make_shared<const std::vector<TestRun>>(std::move(corrected))};
    }
    return corrected_->runs;
}

}  // namespace wems::identify::updating
