/// @file
/// Motion of one rigid part from channels of its points: least squares at each sample on its own.
///
/// With complete triads the equations are solved in the body's own frame, where the linear problem never changes: one
/// pseudo-inverse serves all samples, and Gauss–Newton from the pose before converges to round-off in two or three
/// steps (the same minimum as Kabsch's, Acta Cryst. A32, 1976, which starts the first sample and any that jumps).
/// With single axes missing, turned sensors or weights the 6 x 6 normal equations are formed for each sample: row i is
/// w_i (nᵀ, (R r_i × n)ᵀ), n = R n_i for a sensor that turns with the part.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/mount_forces.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// The channels of one part and one derivative (displacement, velocity, acceleration) as a matrix.

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

/// Linear map from (velocity of `origin`, angular velocity · `length`) to each channel, at rest: rows
/// (nᵀ, (r × n)ᵀ/length), n the channel's direction, r = position − origin; channels x 6.
Eigen::MatrixXd makeDesign(const std::vector<MarkerChannel>& channels, const Eigen::Vector3d& origin, double length);

class RigidFit {
public:
    /// @param rest pose at rest, from which displacements are counted
    RigidFit(ChannelSet set, const BodyMotion& rest);

    /// Which of the six motions (`translation x`, `rotation about z` …) these channels leave open; empty if none.
    const std::vector<std::string>& undetermined() const { return undetermined_; }
    int redundancy() const { return set_.count() - 6; }
    const ChannelSet& channelSet() const { return set_; }

    /// Standard deviations of (origin, rotation) from unit noise on every channel (of weight 1), at rest: 3 (m/m), 3
    /// (rad/m).
    Eigen::Matrix<double, 6, 1> calcUnitDeviations() const;
    /// Their covariance.
    Eigen::Matrix<double, 6, 6> calcUnitCovariance() const;
    /// `residuals` times the channels' weights: all of the noise of a channel of weight 1.
    Eigen::MatrixXd weigh(const Eigen::MatrixXd& residuals) const;

    /// Poses from displacements: origin p (m) and rotation vector theta (rad), 3 x samples.
    /// @param[out] residuals measured minus rigid, channels x samples, m; may be null
    void solvePoses(Eigen::Matrix3Xd& p, Eigen::Matrix3Xd& theta, Eigen::MatrixXd* residuals) const;

    /// Accelerations a (m/s²) of the origin and alpha (rad/s²) from a_i = a + α × r_i + ω × (ω × r_i), r_i = R X_i.
    /// @param theta, w rotation vectors and angular velocities, 3 x samples
    /// @param[out] residuals measured minus rigid, channels x samples, m/s²; may be null
    void solveAccelerations(const Eigen::Matrix3Xd& theta, const Eigen::Matrix3Xd& w, Eigen::Matrix3Xd& a,
                            Eigen::Matrix3Xd& alpha, Eigen::MatrixXd* residuals) const;

private:
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    using Vector6 = Eigen::Matrix<double, 6, 1>;

    void findUndetermined();
    BodyMotion calcKabsch(const Eigen::Matrix3Xd& ends) const;
    bool refineTriads(const Eigen::Matrix3Xd& ends, BodyMotion& pose) const;
    bool refineRows(const Eigen::Ref<const Eigen::VectorXd>& ends, BodyMotion& pose) const;
    /// Weighted row of the normal equations of the part turned by R.
    Vector6 calcRow(int channel, const Eigen::Matrix3d& R) const;
    Eigen::Vector3d calcDirection(int channel, const Eigen::Matrix3d& R) const;

    ChannelSet set_;
    BodyMotion rest_;
    bool triads_ = false;
    Eigen::Matrix3Xd points_;         // with triads: body positions, one column for each connection
    Eigen::VectorXd rest_ends_;       // ground coordinate of each channel at rest
    Eigen::MatrixXd pseudo_inverse_;  // 6 x channels, body frame, with triads
    std::vector<std::string> undetermined_;
};

}  // namespace wems::identify
