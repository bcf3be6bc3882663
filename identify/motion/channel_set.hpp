/// @file
/// The channels of one part and one derivative (displacement, velocity, acceleration) as a matrix.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// One scalar channel: the motion of the point `position` (m, in its part's frame) along one ground axis.
struct MarkerChannel {
    std::string name;    ///< as in the recording, `mobile.1.z`
    int connection = 0;  ///< index in the model
    int axis = 0;        ///< 0 x, 1 y, 2 z
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

/// Channels ordered by connection, then axis; column k of `values` is sample k.
struct ChannelSet {
    std::string file;  ///< of the recording
    Part part = Part::mobile;
    Derivative derivative = Derivative::displacement;
    std::vector<MarkerChannel> channels;
    Eigen::MatrixXd values;  ///< channels x samples, SI

    bool empty() const { return channels.empty(); }
    int count() const { return static_cast<int>(channels.size()); }
    /// Every connection that occurs has all three axes.
    bool hasCompleteTriads() const;
};

/// @throws InputError if a channel names a connection that the model does not have, or holds a value that is not
/// finite.
ChannelSet collectChannels(const Recording& recording, const MountModel& model, Part part, Derivative derivative);

/// The connections among `channels`, each once: index in the model, in channel order.
std::vector<int> connectionsOf(const std::vector<MarkerChannel>& channels);

}  // namespace wems::identify
