#include "identify/verdict/free_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "identify/forward/forward_model.hpp"
#include "identify/forward/initial_state.hpp"
#include "identify/forward/relative_displacement.hpp"
#include "identify/forward/simulated_recording.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/smoothing_kernel.hpp"
#include "models/bryant.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

// Steps for each that the forward model takes for speed. A kink inside a step costs its order, and contact amplifies
// it: 3.6 % of a sensitive run became 0.06 %, where noise alone makes 0.4 %.
constexpr int kFiner = 2;

Eigen::MatrixXd simulate(const RunMotion& run, const MountModel& model) {
    const ForwardModel forward(model);
    TimeGrid grid = makeGrid(run, model);
    grid.steps_per_sample *= kFiner;
    const auto drive = Drive::make(run, model, grid);
    const ForwardState initial = makeInitialState(forward, findStartMotion(run, model, drive), drive);
    Eigen::MatrixXd q = forward.simulate(drive, initial, 0, grid.samples).q;
    q.colwise() -= forward.restDisplacement();
    return q;
}

/// Both sides above a frequency, where below it nothing was measured.
Eigen::MatrixXd keepAbove(const Eigen::MatrixXd& rows, double frequency, double interval) {
    if (frequency <= 0) return rows;
    Eigen::MatrixXd kept(rows.rows(), rows.cols());
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
        kept.row(i) = highPass(rows.row(i).transpose(), interval, frequency).transpose();
    return kept;
}

}  // namespace

double calcLowestCompared(const RunMotion& run) {
    return kComparedMargin *
           std::max(run.mobile.displacement_measured ? 0.0 : run.trusted_from, run.fixed_trusted_from);
}

double calcExplainable(const FreeError& error) {
    return std::max(error.error * error.error - error.driven.square,
                    std::min(error.error * error.error, error.driven.deviation));
}

bool isWorthless(const FreeError& with, const FreeError& without) {
    if (with.diverged) return true;
    return without.error * without.error - with.error * with.error <
           ((1 + kWorth) * (1 + kWorth) - 1) * calcExplainable(with);
}

bool isImproved(const FreeError& before, const FreeError& after) {
    if (before.diverged || after.diverged) return before.diverged && !after.diverged;
    return before.error * before.error - after.error * after.error >=
           (1 - (1 - kWorth) * (1 - kWorth)) * calcExplainable(before);
}

bool isSpoilt(const FreeError& before, const FreeError& after) {
    return isWorthExplaining(after) && after.error > (1 + kWorth) * before.error;
}

bool isBelowNoise(const FreeError& with, const FreeError& without) {
    return without.error < std::hypot(with.error, with.noise_floor);
}

// White acceleration noise integrated twice above a frequency f leaves 2 h σ² I / ((2π)⁴ f³), of which the rigid fit of
// n triads lets 2 / n through, and all of what contact folds. I = ∫ gain² (f / ν)⁴ dν / f of the high pass is 1/3 from
// f on and 0.179 below.
double calcNoiseVariance(const FreeRun& free, const MountModel& model) {
    const RunMotion& run = *free.motion;
    const auto connections = model.connections.size();
    constexpr double passed = 0.512;
    const double twice_integrated =
        2 * run.interval * passed / (std::pow(kTwoPi, 4) * std::pow(kComparedMargin * run.trusted_from, 3));
    const auto isIntegrated = [](const PartMotion& part) {
        return !part.displacement_measured && part.acceleration_measured;
    };
    const auto square = [&](const PartMotion& part, std::size_t side) {
        if (free.displacement_noise.at(side)) return *free.displacement_noise.at(side);
        const bool integrated = isIntegrated(part);
        const double noise = integrated ? part.acceleration_noise : part.displacement_noise;
        if (!std::isfinite(noise)) return 0.0;
        if (!integrated) return noise * noise;
        return std::min(1.0, 2.0 / static_cast<double>(connections)) * noise * noise * twice_integrated;
    };
    const double by_mobile = isIntegrated(run.mobile) ? 1 : 0, by_fixed = isIntegrated(run.fixed) ? 1 : 0;
    double folded = 0;
    if (by_mobile + by_fixed > 0) {
        const auto aliasing = calcAliasing(run);
        for (std::size_t i = 0; i < connections; ++i)
            for (int a = 0; a < 3; ++a) {
                const auto d = calcAxisDirection(model, static_cast<int>(i), a);
                Eigen::Matrix<double, 12, 1> relative;
                relative << by_mobile * d, -by_fixed * d;
                folded += relative.dot(aliasing * relative) / static_cast<double>(3 * connections) * twice_integrated;
            }
    }
    return square(run.mobile, 0) + square(run.fixed, 1) + folded;
}

Eigen::MatrixXd calcFreeResidual(const FreeRun& run, const MountModel& model) {
    return keepAbove(simulate(*run.motion, model) - run.measured, calcLowestCompared(*run.motion),
                     run.motion->interval);
}

double calcComparedSquares(const FreeRun& run) {
    return keepAbove(run.measured, calcLowestCompared(*run.motion), run.motion->interval).squaredNorm();
}

Eigen::MatrixXd calcMeasuredRelative(const Recording& recording, const RunMotion& run, const MountModel& model) {
    const auto samples = static_cast<Eigen::Index>(run.time.size());
    Eigen::MatrixXd q(3 * model.connections.size(), samples);
    const PartMotion body = matchBand(run, model);
    const Eigen::VectorXd rest = calcRestDisplacement(model);
    const bool same_times = recording.sampleCount() == run.time.size();
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        const auto& connection = model.connections[i];
        const Channel *mobile[3], *fixed[3];
        bool complete = same_times && run.mobile.displacement_measured && run.fixed.displacement_measured;
        for (int a = 0; a < 3; ++a) {
            mobile[a] = recording.find("mobile." + connection.name + "." + kAxes[a]);
            fixed[a] = recording.find("fixed." + connection.name + "." + kAxes[a]);
            complete = complete && mobile[a] != nullptr && fixed[a] != nullptr;
        }
        for (Eigen::Index k = 0; k < samples; ++k) {
            const Eigen::Matrix3d R_FG = rotationFromVector(run.fixed.theta.col(k)).transpose();
            Eigen::Ref<Eigen::Vector3d> relative = q.block<3, 1>(3 * i, k);
            if (complete) {
                for (int a = 0; a < 3; ++a) relative[a] = mobile[a]->values[k] - fixed[a]->values[k];
                relative = (R_FG * relative).eval();
            } else {
                const Eigen::Matrix3d R_FM = R_FG * rotationFromVector(body.theta.col(k));
                relative = R_FG * (body.p.col(k) - run.fixed.p.col(k)) + R_FM * connection.position -
                           connection.position - rest.segment<3>(3 * i);
            }
        }
    }
    return q;
}

namespace {

/// The same, the simulated side sampled and integrated as the measured one: without a filter contact folds into both
/// alike.
double calcSampledDifference(const FreeRun& run, const MountModel& model) {
    const RunMotion sampled = estimateMotion(simulateRecording(*run.motion, model, {0, 0}), model);
    const Eigen::MatrixXd simulated = calcMeasuredRelative({}, sampled, model);
    if (simulated.cols() != run.measured.cols()) return std::numeric_limits<double>::infinity();
    return keepAbove(simulated - run.measured, calcLowestCompared(*run.motion), run.motion->interval).squaredNorm();
}

}  // namespace

FreeError calcFreeError(const std::vector<FreeRun>& runs, const MountModel& model) {
    FreeError result;
    double difference = 0, sampled = 0, signal = 0, noise = 0;
    for (const auto& run : runs) {
        signal += calcComparedSquares(run);
        noise += calcNoiseVariance(run, model) * static_cast<double>(run.measured.size());
        try {
            const double own = calcFreeResidual(run, model).squaredNorm();
            difference += own;
            sampled += calcLowestCompared(*run.motion) > 0 ? calcSampledDifference(run, model) : own;
        } catch (const SimulationDiverged&) {
            result.diverged = true;
        }
    }
    // Whether accelerometers had a filter is not known: what they read is compared in the way that fits.
    difference = std::min(difference, sampled);
    result.error = result.diverged ? std::numeric_limits<double>::infinity() : std::sqrt(difference / signal);
    result.noise_floor = std::sqrt(noise / signal);
    return result;
}

}  // namespace wems::identify
