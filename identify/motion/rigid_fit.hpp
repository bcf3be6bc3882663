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

#include "identify/motion/channel_set.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

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
