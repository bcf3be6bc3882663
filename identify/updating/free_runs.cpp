#include "identify/updating/free_runs.hpp"

#include <cmath>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/updating/naming.hpp"
#include "identify/verdict/driven_noise.hpp"

namespace wems::identify::updating {
namespace {

/// A point whose sensors have nothing wrong but what the causes of a set say.
TestPoint keepNamedFaults(const TestProblem& problem, const TestPoint& point, const HypothesisSet& set) {
    TestPoint kept{{point.state.model, SensorErrors(problem.layout())}, point.values};
    for (const int h : set) {
        const Hypothesis& hypothesis = problem.hypotheses()[h];
        if (!isSensorFault(hypothesis)) continue;
        for (const int index : hypothesis.reported) problem.table()[index].set(kept.state, point.values[index]);
    }
    return kept;
}

}  // namespace

FreeRuns::FreeRuns(const TestProblem& problem, std::size_t first, std::size_t count)
    : problem_(problem), first_(first) {
    const MountModel believed = problem.believedPoint().state.model;
    for (std::size_t r = first; r < first + count; ++r) {
        const TestRun& run = problem.runs()[r];
        recorded_.push_back({&run.motion, calcMeasuredRelative(run.recording, run.motion, believed),
                             problem.calcDisplacementNoise(r), problem.calcDriveNoise(r)});
    }
}

FreeRuns::Corrected FreeRuns::correct(const TestPoint& point, const HypothesisSet& set) const {
    Corrected corrected;
    corrected.runs = recorded_;
    const TestPoint faulty = keepNamedFaults(problem_, point, set);
    if (faulty.state.sensors.isZero()) return corrected;
    corrected.exact.resize(recorded_.size());
    runParallel(recorded_.size(),
                [&](std::size_t r) { corrected.exact[r] = problem_.calcExactRun(first_ + r, faulty); });
    for (std::size_t r = 0; r < recorded_.size(); ++r) {
        corrected.runs[r].motion = &corrected.exact[r].motion;
        corrected.runs[r].measured = corrected.exact[r].relative;
    }
    return corrected;
}

FreeError FreeRuns::calcError(const TestPoint& point, const HypothesisSet& set) const {
    const Corrected corrected = correct(point, set);
    return calcFreeError(corrected.runs, problem_.cleanModel(point));
}

DrivenNoise FreeRuns::calcDriven(const MountModel& model, unsigned seed) const {
    double mean = 0, variance = 0, signal = 0;
    for (const FreeRun& run : recorded_) {
        const auto values = static_cast<double>(run.measured.size());
        const DrivenNoise own = calcDrivenNoise(run, model, seed);
        mean += values * own.square;
        variance += std::pow(values * own.deviation, 2);
        signal += calcComparedSquares(run);
    }
    return {mean / signal, std::sqrt(variance) / signal};
}

double FreeRuns::calcNoiseFloor(const MountModel& model, unsigned seed) const {
    double noise = 0, signal = 0;
    for (const FreeRun& run : recorded_) {
        noise += static_cast<double>(run.measured.size()) * calcNoiseVariance(run, model);
        signal += calcComparedSquares(run);
    }
    return std::sqrt(noise / signal + calcDriven(model, seed).square);
}

}  // namespace wems::identify::updating
