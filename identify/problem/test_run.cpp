#include "identify/problem/test_run.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/motion/hum.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "identify/problem/fast_motion.hpp"
#include "identify/problem/unseen_noise.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"

namespace wems::identify {
namespace {

// A stop bends the motion: with 4.4 harmonics a true model in deep contact left 230 and 2600 times the noise where it
// leaves 23 and 510 with 13.
constexpr double kHarmonics = 13;
constexpr double kSpectrumBands = 4;  // bands of the noise's spectrum below the lowest driven frequency
constexpr double kLeastNoise = 1e-7;  // of a channel's RMS: what a file of seven digits rounds off
constexpr double kUnseen = 1e-10;     // relative singular value of motions that channels do not show

/// Channels minus the best rigid motion, with the turning of the part taken exactly.
Eigen::MatrixXd calcRigidResidual(const SensorLayout& layout, const GroupSamples& samples, const SensorGroup& group,
                                  const PartMotion& part, int& freedom) {
    Eigen::MatrixXd residual = samples.values;
    for (Eigen::Index k = 0; k < residual.cols(); ++k) {
        const Eigen::Matrix3d R = rotationFromVector(part.theta.col(k));
        for (std::size_t c = 0; c < samples.channels.size(); ++c)
            residual(c, k) -= calcChannelMotion(layout.channels[samples.channels[c]], group.derivative, R,
                                                part.p.col(k), part.w.col(k), part.a.col(k), part.alpha.col(k));
    }
    const Eigen::MatrixXd design = makeChannelDesign(layout, samples.channels);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(design, Eigen::ComputeThinU);
    residual.colwise() -= residual.rowwise().mean().eval();  // displacements count from rest
    const auto rank = (svd.singularValues().array() > kUnseen * svd.singularValues()[0]).count();
    const Eigen::MatrixXd basis = svd.matrixU().leftCols(rank);
    freedom = static_cast<int>(design.rows() - rank);
    if (freedom <= 0) return samples.values;
    return residual - basis * (basis.transpose() * residual);
}

double meanSquare(const Eigen::MatrixXd& values) {
    return values.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, values.size()));
}

/// Hz. What a part does may reach lower than the sine that drives it: what is left of its start, or creep. A spectrum
/// that told such frequencies apart would have no stretch in which the sine is elsewhere.
double findDrivenFrom(const SweptFrequency& swept) {
    if (!swept.is_sine) return swept.lowest;
    double lowest = swept.highest;
    for (const double hertz : swept.hertz)
        if (hertz < lowest) lowest = hertz;  // not where it is not known
    return lowest;
}

double calcNoiseResolution(const SweptFrequency& swept) {
    return findDrivenFrom(swept) / kSpectrumBands;
}

/// A load has no redundancy under any drive.
NoiseDensity findLoadNoise(const Eigen::Matrix3Xd& load, const ExcitedBand& band, double interval, double resolution) {
    int axes = 0;
    for (Eigen::Index a = 0; a < 3; ++a) axes += load.row(a).isZero(0.0) ? 0 : 1;
    return estimateNoiseBesideBand(load, std::max(1, axes), band, interval, resolution,
                                   kLeastNoise * kLeastNoise * meanSquare(load));
}

}  // namespace

double calcChannelMotion(const SensorChannel& channel, Derivative derivative, const Eigen::Matrix3d& R,
                         const Eigen::Vector3d& p, const Eigen::Vector3d& w, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& alpha) {
    const Eigen::Vector3d r = R * channel.position;
    const Eigen::Vector3d n = channel.turning ? Eigen::Vector3d(R * channel.direction) : channel.direction;
    if (derivative == Derivative::displacement) return n.dot(p + r - channel.position);
    return n.dot(a + alpha.cross(r) + w.cross(w.cross(r)));
}

GroupSamples collectGroup(const Recording& recording, const SensorLayout& layout, int group) {
    GroupSamples result;
    std::vector<const Channel*> found;
    for (const int index : layout.groups[group].channels)
        if (const Channel* channel = recording.find(layout.channels[index].name)) {
            result.channels.push_back(index);
            found.push_back(channel);
        }
    result.values.resize(found.size(), recording.sampleCount());
    for (std::size_t i = 0; i < found.size(); ++i)
        result.values.row(i) = Eigen::Map<const Eigen::RowVectorXd>(found[i]->values.data(), found[i]->values.size());
    return result;
}

Eigen::MatrixXd makeChannelDesign(const SensorLayout& layout, const std::vector<int>& channels) {
    Eigen::MatrixXd design(channels.size(), 6);
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const auto& channel = layout.channels[channels[i]];
        design.row(i) << channel.direction.transpose(), channel.position.cross(channel.direction).transpose();
        design.row(i) = design.row(i).cwiseProduct(channel.freedom.transpose()).eval();
    }
    return design;
}

std::vector<NoiseDensity> estimateChannelNoise(const TestRun& run, const SensorLayout& layout) {
    const double interval = run.motion.interval, driven = findDrivenFrom(run.swept),
                 resolution = calcNoiseResolution(run.swept);
    std::vector<NoiseDensity> noise;
    for (std::size_t g = 0; g < layout.groups.size(); ++g) {
        const GroupSamples samples = collectGroup(run.recording, layout, static_cast<int>(g));
        if (samples.empty()) {
            noise.emplace_back(0.0);
            continue;
        }
        const auto& group = layout.groups[g];
        int freedom = 0;
        const Eigen::MatrixXd residual = calcRigidResidual(
            layout, samples, group, group.part == Part::mobile ? run.motion.mobile : run.motion.fixed, freedom);
        const auto rows = static_cast<int>(residual.rows());
        const double least = kLeastNoise * kLeastNoise * meanSquare(samples.values);
        if (freedom <= 0 && !run.swept.is_sine) {
            noise.push_back(estimateNoiseBesideBand(residual, rows, run.band, interval, resolution, least));
            continue;
        }
        // Without redundancy the channels themselves, in the quarter of the time in which a sweep is elsewhere.
        noise.emplace_back(residual, freedom > 0 ? freedom : rows, interval, resolution, least);
        // Below the sweep motion may be slow, and always there: the creep of a table was taken for 0.2 mm of noise.
        if (freedom <= 0) noise.back().limitBelow(driven);
    }
    return noise;
}

TestRun prepareTestRun(const Recording& recording, const SensorLayout& layout, const MountModel& believed) {
    TestRun run;
    std::vector<std::string> notes;
    run.recording = makeUniform(recording, notes);
    removeDriveHum(run.recording, notes);
    run.swept = findSweptFrequency(run.recording);
    if (!(run.swept.lowest > 0) || !(run.swept.highest > run.swept.lowest * (1 + 1e-9)))
        throw InputError({recording.file, 0, {}},
                         "no motion stands out from the noise, so that nothing is known of the mount",
                         "a recording in which the device is driven or rings");
    run.band = {run.swept.lowest, run.swept.highest, kHarmonics, 0};
    run.motion = estimateMotion(run.recording, believed, ContactEdges::filtered);
    run.noise = estimateChannelNoise(run, layout);
    if (reachesStops(makeOpenLoopRun(run.motion, believed, run.band, {}), believed))
        run.band.contact = calcContactFrequency(believed);
    if (run.motion.load.cols() > 0)
        run.load_noise = findLoadNoise(run.motion.load, run.band, run.motion.interval, calcNoiseResolution(run.swept));
    return run;
}

}  // namespace wems::identify
