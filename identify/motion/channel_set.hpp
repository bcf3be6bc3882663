/// @file
/// The channels of one part and one derivative (displacement, velocity, acceleration) as a matrix.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// One scalar channel: the motion of the point `position` (m, in its part's frame) along one direction.
struct MarkerChannel {
    std::string name;     ///< as in the recording, `mobile.1.z`
    std::string station;  ///< connection, or sensor of the laboratory's own layout
    int index = 0;        ///< of the station: a connection's index in the model, after them the sensors'
    int axis = 0;         ///< 0 x, 1 y, 2 z of the sensor
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< in ground axes at rest
    bool turning = false;                                  ///< the direction turns with the part (accelerometers)
    double weight = 1;                                     ///< of its equation: noise of the best channel over its own

    /// Measures along its own ground axis, with the weight of all.
    bool isPlain() const;
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
    /// Every station that occurs has all three axes, along those of the ground, and all channels one weight.
    bool hasCompleteTriads() const;
};

/// @throws InputError if a channel names a connection or sensor that the model does not have, or holds a value that is
/// not finite.
ChannelSet collectChannels(const Recording& recording, const MountModel& model, Part part, Derivative derivative);

}  // namespace wems::identify
