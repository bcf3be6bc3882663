#include "identify/forward/relative_displacement.hpp"

#include <algorithm>
#include <limits>

#include "identify/motion/motion.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {
namespace {

void addSweep(const Recording& uniform, RelativeDisplacement& result) {
    const SweptFrequency swept = findSweptFrequency(uniform);
    result.swept_frequency = swept.hertz;
    result.lowest_frequency = swept.lowest;
    if (result.swept_frequency.size() != static_cast<Eigen::Index>(result.time.size()))
        result.swept_frequency =
            Eigen::VectorXd::Constant(result.time.size(), std::numeric_limits<double>::quiet_NaN());
}

/// Displacement of one axis of one point: as recorded, or integrated from its acceleration.
struct Axis {
    Eigen::RowVectorXd values;
    bool integrated = false;
};
bool findAxis(const Recording& recording, ChannelName name, double lowest, Axis& axis) {
    const Eigen::Index samples = recording.sampleCount();
    name.derivative = Derivative::displacement;
    if (const Channel* channel = recording.find(formatChannelName(name))) {
        axis = {Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), samples), false};
        return true;
    }
    name.derivative = Derivative::acceleration;
    const Channel* channel = recording.find(formatChannelName(name));
    if (channel == nullptr) return false;
    if (!(lowest > 0))
        throw InputError({recording.file, 0, channel->name},
                         "only accelerations were recorded, and the lowest excited frequency cannot be told",
                         "displacement channels, or a load or base channel beside the accelerations");
    const Eigen::VectorXd a = Eigen::Map<const Eigen::VectorXd>(channel->values.data(), samples);
    axis = {integrateTwice(a, recording.sampleInterval(), kIntegrationMargin * lowest).x.transpose(), true};
    return true;
}

}  // namespace

PartMotion matchBand(const RunMotion& run, const MountModel& model) {
    PartMotion mobile = run.mobile;
    if (!(run.fixed_trusted_from > 0) || run.mobile_trusted_from > 0) return mobile;
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    const BodyMotion fixed_rest = findFixedRest(model, rest);
    const auto integrate = [&](const Eigen::Matrix3Xd& acceleration, int row) -> Eigen::RowVectorXd {
        return integrateTwice(acceleration.row(row).transpose(), run.interval, run.fixed_trusted_from).x.transpose();
    };
    const Eigen::Matrix3Xd a = run.mobile.a - run.fixed.a, alpha = run.mobile.alpha - run.fixed.alpha;
    mobile.p = run.fixed.p.colwise() + (rest.mobile.p_GM - fixed_rest.p_GM);
    mobile.theta =
        run.fixed.theta.colwise() + (vectorFromRotation(rest.mobile.R_GM) - vectorFromRotation(fixed_rest.R_GM));
    for (int i = 0; i < 3; ++i) {
        mobile.p.row(i) += integrate(a, i);
        mobile.theta.row(i) += integrate(alpha, i);
    }
    return mobile;
}

Eigen::VectorXd calcRestDisplacement(const MountModel& model) {
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    FrameMotion frame;
    if (!model.bracket.empty())
        frame = Bracket(model.bracket).calcMotion(rest.eta, Eigen::VectorXd::Zero(rest.eta.size()));
    Eigen::VectorXd displacement(3 * model.connections.size());
    Eigen::Index row = 0;
    for (const Connection& connection : model.connections) {
        displacement.segment<3>(row) = calcRelativeMotion(rest.mobile, frame, connection.position).q;
        row += 3;
    }
    return displacement;
}

RelativeDisplacement calcRelativeDisplacement(const RunMotion& run, const MountModel& model) {
    RelativeDisplacement result;
    result.file = run.file;
    result.time = run.time;
    result.notes = run.notes;
    result.from_accelerations = !run.mobile.displacement_measured || run.fixed_trusted_from > 0;
    const auto samples = static_cast<Eigen::Index>(run.time.size());
    const Eigen::Index connections = model.connections.size();
    result.q.resize(3 * connections, samples);
    const PartMotion mobile = matchBand(run, model);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const Eigen::Matrix3d R_FG = rotationFromVector(run.fixed.theta.col(k)).transpose();
        const Eigen::Matrix3d R_FM = R_FG * rotationFromVector(mobile.theta.col(k));
        const Eigen::Vector3d p_FM = R_FG * (mobile.p.col(k) - run.fixed.p.col(k));
        for (Eigen::Index i = 0; i < connections; ++i) {
            const Eigen::Vector3d& r = model.connections[i].position;
            result.q.block<3, 1>(3 * i, k) = p_FM + R_FM * r - r;
        }
    }
    result.q.colwise() -= calcRestDisplacement(model);
    for (const Connection& connection : model.connections)
        for (const char* axis : {".x", ".y", ".z"}) result.names.push_back(connection.name + axis);
    return result;
}

RelativeDisplacement calcRelativeDisplacement(const Recording& recording, const MountModel& model) {
    RelativeDisplacement result = calcRelativeDisplacement(estimateMotion(recording, model), model);
    std::vector<std::string> notes;
    addSweep(makeUniform(recording, notes), result);
    return result;
}

RelativeDisplacement calcRelativeDisplacement(const Recording& recording) {
    RelativeDisplacement result;
    result.file = recording.file;
    const Recording uniform = makeUniform(recording, result.notes);
    result.time = uniform.time;
    addSweep(uniform, result);
    const bool mobile_alone = uniform.connections(Part::fixed).empty();
    std::vector<Eigen::RowVectorXd> rows;
    for (const std::string& connection : uniform.connections(Part::mobile)) {
        for (int k = 0; k < 3; ++k) {
            Axis mobile, fixed;
            if (!findAxis(uniform, {Part::mobile, connection, k, {}}, result.lowest_frequency, mobile)) continue;
            result.from_accelerations |= mobile.integrated;
            if (!mobile_alone) {
                const ChannelName counterpart{Part::fixed, connection, k, Derivative::displacement};
                if (!findAxis(uniform, counterpart, result.lowest_frequency, fixed))
                    throw InputError({recording.file, 0, formatChannelName(counterpart)},
                                     "this channel is missing, while the same axis of the mobile part was recorded",
                                     "displacement or acceleration of both ends, or of the mobile ends alone");
                result.from_accelerations |= fixed.integrated;
                mobile.values -= fixed.values;
            }
            rows.push_back(std::move(mobile.values));
            result.names.push_back(connection + "." + "xyz"[k]);
        }
    }
    if (rows.empty())
        throw InputError({recording.file, 0, "mobile"}, "no displacement or acceleration of the mobile part",
                         "mobile.<connection>.<x|y|z|ax|ay|az>");
    result.q.resize(rows.size(), result.time.size());
    for (std::size_t i = 0; i < rows.size(); ++i) result.q.row(i) = rows[i];
    if (mobile_alone) result.notes.emplace_back("no channels of the fixed part: the mobile part alone is compared");
    return result;
}

void removeSlowMotion(RelativeDisplacement& displacement, double lowest_frequency) {
    for (Eigen::Index i = 0; i < displacement.q.rows(); ++i) {
        const Eigen::VectorXd row = displacement.q.row(i);
        displacement.q.row(i) =
            highPass(row, displacement.interval(), kComparedMargin * kIntegrationMargin * lowest_frequency);
    }
}

}  // namespace wems::identify
