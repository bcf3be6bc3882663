#include "identify/paper/single_axis_data.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "identify/forward/relative_displacement.hpp"
#include "identify/motion/channel_set.hpp"
#include "identify/motion/differentiation.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "identify/motion/uniform_time.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

/// Acceleration of the point `position` of the mobile part, samples × 3.
Eigen::MatrixXd calcPointAcceleration(const PartMotion& motion, const Eigen::Vector3d& position) {
    Eigen::MatrixXd a(motion.a.cols(), 3);
    for (Eigen::Index k = 0; k < motion.a.cols(); ++k) {
        const Eigen::Vector3d lever = rotationFromVector(motion.theta.col(k)) * position;
        const Eigen::Vector3d w = motion.w.col(k), alpha = motion.alpha.col(k);
        a.row(k) = (motion.a.col(k) + alpha.cross(lever) + w.cross(w.cross(lever))).transpose();
    }
    return a;
}

/// Every axis of every connection of the model has a channel in `set`.
bool isComplete(const ChannelSet& set, const MountModel& model) {
    const auto of_connection = [&](const MarkerChannel& channel) {
        return channel.index < static_cast<int>(model.connections.size()) && channel.isPlain();
    };
    return set.count() == 3 * static_cast<int>(model.connections.size()) && set.hasCompleteTriads() &&
           std::all_of(set.channels.begin(), set.channels.end(), of_connection);
}

}  // namespace

SingleAxisData collectSingleAxisData(const Recording& recording, const MountModel& model) {
    SingleAxisData data;
    const Recording uniform = makeUniform(recording, data.notes);
    const RunMotion motion = estimateMotion(uniform, model);
    data.notes.insert(data.notes.end(), motion.notes.begin(), motion.notes.end());
    data.hertz = findSweptFrequency(uniform).hertz;

    const ChannelSet mobile = collectChannels(uniform, model, Part::mobile, Derivative::displacement);
    const ChannelSet fixed = collectChannels(uniform, model, Part::fixed, Derivative::displacement);
    if (isComplete(mobile, model) && isComplete(fixed, model)) {
        data.q = (mobile.values - fixed.values).transpose();
    } else {
        data.q = calcRelativeDisplacement(motion, model).q.transpose();
    }
    data.v.resize(data.q.rows(), data.q.cols());
    for (Eigen::Index j = 0; j < data.q.cols(); ++j)
        data.v.col(j) = differentiate(data.q.col(j), motion.interval).first;

    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Connection& connection : model.connections)
        centre += connection.position / static_cast<double>(model.connections.size());
    const ChannelSet acceleration = collectChannels(uniform, model, Part::mobile, Derivative::acceleration);
    if (isComplete(acceleration, model)) {
        data.a_centre = Eigen::MatrixXd::Zero(data.q.rows(), 3);
        for (int i = 0; i < acceleration.count(); ++i)
            data.a_centre.col(acceleration.channels[i].axis) +=
                acceleration.values.row(i).transpose() / static_cast<double>(model.connections.size());
    } else {
        data.a_centre = calcPointAcceleration(motion.mobile, centre);
    }
    data.a_body = calcPointAcceleration(motion.mobile, model.body.center_of_gravity);
    return data;
}

}  // namespace wems::identify
