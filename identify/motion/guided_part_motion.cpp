#include "identify/motion/guided_part_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/motion/differentiation.hpp"
#include "identify/motion/fusion.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/part_estimator.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/bryant.hpp"
#include "models/guided_motion.hpp"

namespace wems::identify {
namespace {

/// Gauss–Newton on the free coordinates: quadratic convergence, so that few steps reach rounding.
constexpr int most_newton_steps = 20;
constexpr double newton_tolerance = 1e-10;  // m, rad

FrameMotion frameAt(const PartMotion& motion, Eigen::Index k) {
    return {rotationFromVector(motion.theta.col(k)), motion.p.col(k), motion.w.col(k), motion.v.col(k)};
}

/// Channels of one kind, as equations for the free coordinates.
class GuidedFit {
public:
    GuidedFit(ChannelSet set, const GuidedMotion& guide, const BodyMotion& rest) : set_(std::move(set)), guide_(guide) {
        const Eigen::Index count = set_.count();
        rest_ends_.resize(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            const MarkerChannel& channel = channelAt(i);
            rest_ends_[i] = channel.direction.dot(rest.p_GM + rest.R_GM * channel.position);
        }
        findUndetermined(rest);
    }

    const ChannelSet& channelSet() const { return set_; }
    const std::vector<std::string>& undetermined() const { return undetermined_; }
    int redundancy() const { return set_.count() - static_cast<int>(guide_.free().size()); }
    /// Of the free coordinates from unit noise on every channel.
    const Eigen::MatrixXd& covariance() const { return covariance_; }

    /// Least squares for s, starting there. @param[out] residual weighted, one for each channel
    void solvePose(const FrameMotion& frame, Eigen::Index k, Vector6& s, Eigen::Ref<Eigen::VectorXd> residual) const {
        for (int step = 0; step < most_newton_steps; ++step) {
            const BodyMotion pose = composeMotion(frame, s, Vector6::Zero());
            const Eigen::MatrixXd rows = calcRows(pose.R_GM, frame.R_GF, s);
            for (Eigen::Index i = 0; i < rows.rows(); ++i) {
                const MarkerChannel& channel = channelAt(i);
                residual[i] = channel.weight * (set_.values(i, k) + rest_ends_[i] -
                                                channel.direction.dot(pose.p_GM + pose.R_GM * channel.position));
            }
            const Eigen::VectorXd change = (rows.transpose() * rows).ldlt().solve(rows.transpose() * residual);
            add(change, s);
            if (!(change.cwiseAbs().maxCoeff() > newton_tolerance)) break;
        }
    }

    /// Least squares for s''. @param[out] residual weighted, one for each channel
    Vector6 solveAcceleration(const FrameMotion& frame, const Vector6& frame_acceleration, Eigen::Index k,
                              const Vector6& s, const Vector6& rates, Eigen::Ref<Eigen::VectorXd> residual) const {
        const BodyMotion pose = composeMotion(frame, s, rates);
        const Vector6 bias = composeAcceleration(frame, frame_acceleration, s, rates, Vector6::Zero());
        const Eigen::Matrix3d W = crossMatrix(pose.w_GM);
        const Eigen::Matrix3d field = (crossMatrix(bias.tail<3>()) + W * W) * pose.R_GM;
        for (Eigen::Index i = 0; i < set_.count(); ++i) {
            const MarkerChannel& channel = channelAt(i);
            const Eigen::Vector3d known = bias.head<3>() + field * channel.position;
            residual[i] = channel.weight * (set_.values(i, k) - calcDirection(channel, pose.R_GM).dot(known));
        }
        const Eigen::MatrixXd rows = calcRows(pose.R_GM, frame.R_GF, s);
        const Eigen::VectorXd solution = (rows.transpose() * rows).ldlt().solve(rows.transpose() * residual);
        residual -= rows * solution;
        Vector6 acceleration = Vector6::Zero();
        add(solution, acceleration);
        return acceleration;
    }

private:
    const MarkerChannel& channelAt(Eigen::Index i) const { return set_.channels[i]; }
    static Eigen::Vector3d calcDirection(const MarkerChannel& channel, const Eigen::Matrix3d& R) {
        return channel.turning ? Eigen::Vector3d(R * channel.direction) : channel.direction;
    }
    void add(const Eigen::VectorXd& free, Vector6& s) const {
        for (Eigen::Index j = 0; j < free.size(); ++j) s[guide_.free()[j]] += free[j];
    }
    /// Weighted rows of channel velocity (or acceleration) to the free rates.
    Eigen::MatrixXd calcRows(const Eigen::Matrix3d& R_GM, const Eigen::Matrix3d& R_GF, const Vector6& s) const {
        Eigen::MatrixXd rows(set_.count(), 6);
        for (Eigen::Index i = 0; i < set_.count(); ++i) {
            const MarkerChannel& channel = channelAt(i);
            const Eigen::Vector3d n = calcDirection(channel, R_GM);
            rows.row(i) << channel.weight * n.transpose(),
                channel.weight * (R_GM * channel.position).cross(n).transpose();
        }
        return guide_.freeColumns(rows * calcRelativeJacobian(R_GF, s));
    }

    void findUndetermined(const BodyMotion& rest) {
        const Eigen::Index free = guide_.free().size();
        Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(free, free);
        double length = 0;
        for (const MarkerChannel& channel : set_.channels) length += channel.position.squaredNorm() / set_.count();
        length = length > 0 ? std::sqrt(length) : 1;
        if (!set_.empty()) {
            const Eigen::MatrixXd rows = calcRows(rest.R_GM, Eigen::Matrix3d::Identity(), Vector6::Zero());
            normal = rows.transpose() * rows;
        }
        Eigen::VectorXd scale(free);  // rotations as the displacement that they make
        for (Eigen::Index j = 0; j < free; ++j) scale[j] = guide_.free()[j] < 3 ? 1 : 1 / length;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
            (scale.asDiagonal() * normal * scale.asDiagonal()).eval());
        // As for six motions: noise of a lost one would be a thousand times that of a channel.
        const double limit = 1e-6 * std::max(solver.eigenvalues().maxCoeff(), 1e-300);
        for (Eigen::Index motion = 0; motion < free; ++motion) {
            double share = 0;
            for (Eigen::Index j = 0; j < free; ++j)
                if (solver.eigenvalues()[j] <= limit) share += std::pow(solver.eigenvectors()(motion, j), 2);
            const char* name = kMotionNames.at(guide_.free()[motion]);
            if (share > 0.05) undetermined_.emplace_back(name);
        }
        if (undetermined_.empty()) covariance_ = normal.inverse();
    }

    ChannelSet set_;
    GuidedMotion guide_;
    Eigen::VectorXd rest_ends_;
    std::vector<std::string> undetermined_;
    Eigen::MatrixXd covariance_;
};

class GuidedEstimator : PartEstimator {
public:
    GuidedEstimator(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                    const PartMotion& reference, ContactEdges edges = ContactEdges::sampled)
        : PartEstimator(recording, part),
          reference_(reference),
          edges_(edges),
          samples_(recording.sampleCount()),
          guide_(model.body),
          displacement_(collectChannels(recording, model, part, Derivative::displacement), guide_, rest),
          acceleration_(collectAccelerations(model, displacement_.channelSet()), guide_, rest) {
        const FrameMotion frame = findReferenceRest(model, rest);
        rest_ = calcRelativeCoordinates(rest, frame);
    }

    bool determined() const { return displacement_.undetermined().empty() || acceleration_.undetermined().empty(); }

    PartEstimate estimate() {
        const bool displacement = displacement_.undetermined().empty();
        const bool acceleration = acceleration_.undetermined().empty();
        if (!displacement && !acceleration)
            throwUndetermined(displacement_, acceleration_, "channels that determine the free motions of the model");
        begin(displacement, acceleration);
        PartMotion& motion = result_.motion;
        noteFreeMotions();
        s_ = rest_.replicate(1, samples_);
        rate_ = second_ = Eigen::MatrixXd::Zero(6, samples_);
        if (displacement) solvePoses();
        if (displacement && acceleration)
            fuse();
        else if (displacement)
            differentiateDisplacements();
        else
            integrateAccelerations();
        if (displacement) motion.displacement_covariance = expand(displacement_);
        if (acceleration) motion.acceleration_covariance = expand(acceleration_);
        compose();
        return std::move(result_);
    }

private:
    FrameMotion findReferenceRest(const MountModel& model, const BodyMotion& rest) const {
        const BodyMotion frame = part_ == Part::fixed ? rest : findFixedRest(model, findStaticEquilibrium(model));
        FrameMotion still;
        still.R_GF = frame.R_GM;
        still.p_GF = frame.p_GM;
        return still;
    }

    void noteFreeMotions() {
        std::string free;
        for (const int i : guide_.free()) free += (free.empty() ? "" : ", ") + std::string(kMotionNames.at(i));
        note(part_ == Part::mobile ? "its channels determine " + free + ", the other motions are held by the model"
                                   : "its channels determine " + free + ", the other motions are taken as zero");
    }

    double estimateNoise(const GuidedFit& fit, const Eigen::MatrixXd& residuals, const Eigen::MatrixXd& signal) const {
        if (fit.redundancy() > 0) return estimateNoiseFromResiduals(residuals, fit.redundancy());
        double sum = 0;
        for (std::size_t j = 0; j < guide_.free().size(); ++j) {
            const Eigen::Index k = j;
            sum +=
                std::pow(estimateNoiseFromSignal(signal.row(guide_.free()[j]).transpose()), 2) / fit.covariance()(k, k);
        }
        return std::sqrt(sum / static_cast<double>(guide_.free().size()));
    }

    void solvePoses() {
        Eigen::MatrixXd residuals(displacement_.channelSet().count(), samples_);
        Vector6 s = rest_;
        for (Eigen::Index k = 0; k < samples_; ++k) {
            displacement_.solvePose(frameAt(reference_, k), k, s, residuals.col(k));
            s_.col(k) = s;
        }
        result_.motion.displacement_noise = estimateNoise(displacement_, residuals, s_);
        result_.motion.displacement_density =
            estimateNoiseDensity(residuals, displacement_.redundancy(), result_.motion.displacement_noise, interval_);
        result_.motion.displacement_calibration =
            estimateCalibration(displacement_.channelSet(), residuals, std::nan(""));
    }

    /// s'' with the present s and s'; true if it no longer changes.
    bool solveAccelerations() {
        Eigen::MatrixXd residuals(acceleration_.channelSet().count(), samples_);
        double change = 0;
        for (Eigen::Index k = 0; k < samples_; ++k) {
            Vector6 frame_acceleration;
            frame_acceleration << reference_.a.col(k), reference_.alpha.col(k);
            const Vector6 second = acceleration_.solveAcceleration(frameAt(reference_, k), frame_acceleration, k,
                                                                   s_.col(k), rate_.col(k), residuals.col(k));
            change = std::max(change, (second - second_.col(k)).cwiseAbs().maxCoeff());
            second_.col(k) = second;
        }
        result_.motion.acceleration_noise = estimateNoise(acceleration_, residuals, second_);
        result_.motion.acceleration_density =
            estimateNoiseDensity(residuals, acceleration_.redundancy(), result_.motion.acceleration_noise, interval_);
        result_.motion.acceleration_calibration =
            estimateCalibration(acceleration_.channelSet(), residuals, std::nan(""));
        return !(change > kPassTolerance * second_.cwiseAbs().maxCoeff());
    }

    void fuse() {
        const Eigen::MatrixXd measured = s_;
        const double x_noise = std::max({result_.motion.displacement_noise, kLeastDisplacementNoise,
                                         kNoiseFloor * rms(measured.colwise() - rest_)});
        result_.motion.fusion_weights.setZero(6, samples_);
        double a_noise = 0;
        for (int pass = 0; pass < kMostPasses && !solveAccelerations(); ++pass) {
            a_noise =
                std::max({result_.motion.acceleration_noise, kLeastAccelerationNoise, kNoiseFloor * rms(second_)});
            for (std::size_t j = 0; j < guide_.free().size(); ++j) {
                const int i = guide_.free()[j];
                const Eigen::Index c = j;
                const FusedSignal fused = fuseDisplacementAndAcceleration(
                    measured.row(i).transpose(), x_noise * std::sqrt(displacement_.covariance()(c, c)),
                    second_.row(i).transpose(), a_noise * std::sqrt(acceleration_.covariance()(c, c)), interval_,
                    edges_);
                s_.row(i) = fused.x.transpose();
                result_.motion.fusion_weights.row(i) = fused.weights.transpose().cast<float>();
                rate_.row(i) = fused.v.transpose();
            }
        }
        note("displacements and accelerations fused, weighed by their noise; good to " +
             formatHertz(result_.trusted_to));
    }

    void differentiateDisplacements() {
        Eigen::MatrixXd coordinates(guide_.free().size(), samples_);
        for (Eigen::Index j = 0; j < coordinates.rows(); ++j) {
            const int i = guide_.free()[j];
            coordinates.row(j) = (s_.row(i).array() - rest_[i]) / std::sqrt(displacement_.covariance()(j, j));
        }
        const double cutoff = chooseCutoff(coordinates);
        for (const int i : guide_.free()) {
            const Derivatives derivatives =
                differentiate(smoothZeroPhase(s_.row(i).transpose(), interval_, cutoff), interval_);
            rate_.row(i) = derivatives.first.transpose();
            second_.row(i) = derivatives.second.transpose();
        }
        noteDerivatives(cutoff);
    }

    void integrateAccelerations() {
        chooseIntegrationBand();
        for (int pass = 0; pass < kMostPasses && !solveAccelerations(); ++pass) {
            for (const int i : guide_.free()) {
                const IntegratedSignal integral =
                    integrateTwice(second_.row(i).transpose(), interval_, result_.trusted_from);
                s_.row(i) = integral.x.transpose().array() + rest_[i];
                rate_.row(i) = integral.v.transpose();
            }
        }
        noteIntegration();
    }

    /// Covariance of (origin, rotation) at rest.
    Matrix6 expand(const GuidedFit& fit) const {
        const Eigen::MatrixXd J = guide_.freeColumns(calcRelativeJacobian(Eigen::Matrix3d::Identity(), rest_));
        return J * fit.covariance() * J.transpose();
    }

    void compose() {
        PartMotion& motion = result_.motion;
        for (auto* history : {&motion.p, &motion.theta, &motion.v, &motion.w, &motion.a, &motion.alpha})
            history->resize(3, samples_);
        for (Eigen::Index k = 0; k < samples_; ++k) {
            const FrameMotion frame = frameAt(reference_, k);
            const BodyMotion body = composeMotion(frame, s_.col(k), rate_.col(k));
            Vector6 frame_acceleration;
            frame_acceleration << reference_.a.col(k), reference_.alpha.col(k);
            const Vector6 acceleration =
                composeAcceleration(frame, frame_acceleration, s_.col(k), rate_.col(k), second_.col(k));
            motion.p.col(k) = body.p_GM;
            motion.theta.col(k) = vectorFromRotation(body.R_GM);
            motion.v.col(k) = body.v_GM;
            motion.w.col(k) = body.w_GM;
            motion.a.col(k) = acceleration.head<3>();
            motion.alpha.col(k) = acceleration.tail<3>();
        }
    }

    const PartMotion& reference_;
    ContactEdges edges_;
    Eigen::Index samples_;
    GuidedMotion guide_;
    GuidedFit displacement_;
    GuidedFit acceleration_;
    Vector6 rest_ = Vector6::Zero();
    Eigen::MatrixXd s_, rate_, second_;  // 6 x samples
};

}  // namespace

PartEstimate estimateGuided(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                            const PartMotion& reference, ContactEdges edges) {
    return GuidedEstimator(recording, model, part, rest, reference, edges).estimate();
}

bool determinesGuided(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest) {
    return GuidedEstimator(recording, model, part, rest, {}).determined();
}

}  // namespace wems::identify
