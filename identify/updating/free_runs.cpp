#include "identify/updating/free_runs.hpp"

#include <cmath>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/problem/run_noise.hpp"
#include "identify/updating/naming.hpp"
#include "identify/verdict/driven_noise.hpp"
#include "models/common/units.hpp"

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

/// What integration leaves of the accelerations' noise in the displacement of a connection's axis, m²: the mean over
/// all, through the high pass of the comparison. Its spectrum matters: at low frequencies noise has more.
double calcIntegratedNoise(const MotionNoise& noise, Part part, const RunMotion& run, const MountModel& model) {
    const int count = static_cast<int>(model.connections.size());
    Matrix6 axes = Matrix6::Zero();  // Σ d dᵀ
    for (int i = 0; i < count; ++i)
        for (int a = 0; a < 3; ++a) {
            const Vector6 d = calcAxisDirection(model, i, a);
            axes += d * d.transpose() / (3 * count);
        }
    const double spacing = 1 / (static_cast<double>(run.time.size()) * run.interval);
    const double lowest = calcLowestCompared(run), to = 0.5 / run.interval;
    double variance = 0;
    for (double frequency = spacing; frequency < to; frequency += spacing) {
        const double gain = calcHighPassGain(frequency, lowest);
        if (gain == 0) continue;
        variance += 2 * run.interval * spacing * gain * gain *
                    axes.cwiseProduct(noise.covariance(part, kTwoPi * frequency)).sum();
    }
    return variance;
}

std::array<std::optional<double>, 2> calcDisplacementNoise(const TestProblem& problem, const TestRun& run) {
    std::array<std::optional<double>, 2> variances;
    const SensorLayout& layout = problem.layout();
    const MotionNoise noise(run, layout);
    for (std::size_t g = 0; g < layout.groups.size(); ++g) {
        const Part part = layout.groups[g].part;
        const std::size_t side = part == Part::mobile ? 0 : 1;
        const PartMotion& motion = part == Part::mobile ? run.motion.mobile : run.motion.fixed;
        if (layout.groups[g].derivative == Derivative::displacement && motion.displacement_measured)
            variances.at(side) = run.noise[g].variance();
        // What drives without redundancy is drawn with what it drives (driven_noise.hpp).
        const bool counts = part == Part::mobile || std::isfinite(motion.acceleration_noise);
        if (layout.groups[g].derivative == Derivative::acceleration && motion.acceleration_measured &&
            !motion.displacement_measured && counts)
            variances.at(side) = calcIntegratedNoise(noise, part, run.motion, problem.believedPoint().state.model);
    }
    return variances;
}

}  // namespace

FreeRuns::FreeRuns(const TestProblem& problem, std::size_t first, std::size_t count)
    : problem_(problem), first_(first) {
    const MountModel believed = problem.believedPoint().state.model;
    for (std::size_t r = first; r < first + count; ++r) {
        const TestRun& run = problem.runs()[r];
        recorded_.push_back({&run.motion, calcMeasuredRelative(run.recording, run.motion, believed),
                             calcDisplacementNoise(problem, run), problem.calcDriveNoise(r)});
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
