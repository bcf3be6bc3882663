#include "identify/motion/part_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identify/motion/differentiation.hpp"
#include "identify/motion/fusion.hpp"
#include "identify/motion/noise_estimate.hpp"
#include "identify/motion/part_estimator.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Rotations beyond this (rad), got by integration, are a sign of drift or of wrong units.
constexpr double largest_rotation = 1.6;

/// Noise of one channel: from the redundancy of the fit, otherwise from what varies fast in the origin's motion.
double estimateNoise(const RigidFit& fit, const Eigen::MatrixXd& residuals, const Eigen::Matrix3Xd& origin) {
    if (fit.redundancy() > 0) return estimateNoiseFromResiduals(fit.weigh(residuals), fit.redundancy());
    const Vector6 unit = fit.calcUnitDeviations();
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis)
        sum += std::pow(estimateNoiseFromSignal(origin.row(axis).transpose()) / unit[axis], 2) / 3;
    return std::sqrt(sum);
}

/// Angular velocities from rotation vectors and their rates, sample by sample.
Eigen::Matrix3Xd calcAngularVelocities(const Eigen::Matrix3Xd& theta, const Eigen::Matrix3Xd& rate) {
    Eigen::Matrix3Xd w(3, theta.cols());
    for (Eigen::Index k = 0; k < theta.cols(); ++k) w.col(k) = calcAngularVelocity(theta.col(k), rate.col(k));
    return w;
}

class SixMotionEstimator : PartEstimator {
public:
    SixMotionEstimator(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                       ContactEdges edges)
        : PartEstimator(recording, part),
          edges_(edges),
          rest_(rest),
          displacement_(collectChannels(recording, model, part, Derivative::displacement), rest),
          acceleration_(collectAccelerations(model, displacement_.channelSet()), rest) {}

    PartEstimate estimate() {
        const bool displacement = displacement_.undetermined().empty();
        const bool acceleration = acceleration_.undetermined().empty();
        if (!displacement && !acceleration)
            throwUndetermined(
                displacement_, acceleration_,
                "x, y, z at three connections not on one line, or any channels that determine all six motions");
        noteUnused(displacement, acceleration);
        begin(displacement, acceleration);
        PartMotion& motion = result_.motion;
        if (displacement) {
            Eigen::MatrixXd residuals;
            displacement_.solvePoses(motion.p, motion.theta, &residuals);
            motion.displacement_noise = estimateNoise(displacement_, residuals, motion.p);
            motion.displacement_density = findDensity(displacement_, residuals, motion.displacement_noise);
            motion.displacement_calibration =
                calibrate(displacement_, residuals, motion.displacement_noise, "displacement");
            motion.displacement_covariance = displacement_.calcUnitCovariance();
        }
        if (acceleration) motion.acceleration_covariance = acceleration_.calcUnitCovariance();
        if (displacement && acceleration) {
            fuse();
        } else if (displacement) {
            differentiateDisplacements();
        } else {
            integrateAccelerations();
        }
        return std::move(result_);
    }

private:
    Calibration calibrate(const RigidFit& fit, const Eigen::MatrixXd& residuals, double noise, const char* kind) {
        Calibration calibration = estimateCalibration(fit.channelSet(), residuals, noise);
        constexpr double worth_saying = 1e-4;
        if (calibration.gain_scatter > worth_saying) {
            char text[120];
            std::snprintf(text, sizeof text, "the gains of its %s channels scatter by %.2g %%", kind,
                          100 * calibration.gain_scatter);
            note(text);
        }
        return calibration;
    }

    NoiseDensity findDensity(const RigidFit& fit, const Eigen::MatrixXd& residuals, double white) const {
        return estimateNoiseDensity(fit.weigh(residuals), fit.redundancy(), white, interval_);
    }

    void noteUnused(bool displacement, bool acceleration) {
        if (!displacement && !displacement_.channelSet().empty())
            note("displacement channels are not used: too few for the six motions");
        if (!acceleration && !acceleration_.channelSet().empty())
            note("acceleration channels are not used: too few for the six motions");
    }

    /// Rigid accelerations with the centripetal terms of the present angular velocity.
    void solveAccelerations(Eigen::MatrixXd* residuals) {
        PartMotion& motion = result_.motion;
        acceleration_.solveAccelerations(motion.theta, motion.w, motion.a, motion.alpha, residuals);
    }

    /// True if a further pass over the centripetal terms would change nothing that matters.
    bool hasConverged(const Eigen::Matrix3Xd& w_before) const {
        const PartMotion& motion = result_.motion;
        const double change = (motion.w - w_before).cwiseAbs().maxCoeff() * motion.w.cwiseAbs().maxCoeff();
        return !(change > kPassTolerance * motion.alpha.cwiseAbs().maxCoeff());
    }

    Eigen::Matrix3Xd calcVectorAccelerations(const Eigen::Matrix3Xd& rate) const {
        const PartMotion& motion = result_.motion;
        Eigen::Matrix3Xd result(3, motion.theta.cols());
        for (Eigen::Index k = 0; k < motion.theta.cols(); ++k)
            result.col(k) = calcVectorAcceleration(motion.theta.col(k), rate.col(k), motion.alpha.col(k));
        return result;
    }

    void fuse() {
        PartMotion& motion = result_.motion;
        const Eigen::Matrix3Xd p_measured = motion.p, theta_measured = motion.theta;
        Eigen::Matrix3Xd rate = Eigen::Matrix3Xd::Zero(3, motion.p.cols());
        motion.w = rate;
        const Vector6 x_unit = displacement_.calcUnitDeviations(), a_unit = acceleration_.calcUnitDeviations();
        const double x_noise = std::max(
            {motion.displacement_noise, kLeastDisplacementNoise, kNoiseFloor * rms(motion.p.colwise() - rest_.p_GM)});
        motion.fusion_weights.resize(6, motion.p.cols());
        double a_noise = 0;
        Eigen::MatrixXd residuals;
        for (int pass = 0; pass < kMostPasses; ++pass) {
            solveAccelerations(&residuals);
            motion.acceleration_noise = estimateNoise(acceleration_, residuals, motion.a);
            a_noise = std::max({motion.acceleration_noise, kLeastAccelerationNoise, kNoiseFloor * rms(motion.a)});
            const Eigen::Matrix3Xd second = calcVectorAccelerations(rate);
            for (int i = 0; i < 3; ++i) {
                const FusedSignal fused = fuseDisplacementAndAcceleration(
                    theta_measured.row(i).transpose(), x_noise * x_unit[3 + i], second.row(i).transpose(),
                    a_noise * a_unit[3 + i], interval_, edges_);
                motion.theta.row(i) = fused.x.transpose();
                motion.fusion_weights.row(3 + i) = fused.weights.transpose().cast<float>();
                rate.row(i) = fused.v.transpose();
            }
            const Eigen::Matrix3Xd w_before = motion.w;
            motion.w = calcAngularVelocities(motion.theta, rate);
            if (hasConverged(w_before)) break;
        }
        motion.acceleration_density = findDensity(acceleration_, residuals, motion.acceleration_noise);
        motion.acceleration_calibration =
            calibrate(acceleration_, residuals, motion.acceleration_noise, "acceleration");
        motion.v.resize(3, motion.p.cols());
        for (int i = 0; i < 3; ++i) {
            const FusedSignal fused =
                fuseDisplacementAndAcceleration(p_measured.row(i).transpose(), x_noise * x_unit[i],
                                                motion.a.row(i).transpose(), a_noise * a_unit[i], interval_, edges_);
            motion.p.row(i) = fused.x.transpose();
            motion.fusion_weights.row(i) = fused.weights.transpose().cast<float>();
            motion.v.row(i) = fused.v.transpose();
        }
        const double crossover = std::sqrt(a_noise * a_unit[0] / (x_noise * x_unit[0])) / kTwoPi;
        note("displacements and accelerations fused, displacement deciding below " + formatHertz(crossover) +
             ", acceleration above; velocities from both, good to " + formatHertz(result_.trusted_to));
    }

    void differentiateDisplacements() {
        PartMotion& motion = result_.motion;
        const Eigen::Index samples = motion.p.cols();
        const Vector6 unit = displacement_.calcUnitDeviations();
        Eigen::MatrixXd coordinates(6, samples);
        coordinates.topRows(3) = (motion.p.colwise() - rest_.p_GM).array().colwise() / unit.head<3>().array();
        coordinates.bottomRows(3) = motion.theta.array().colwise() / unit.tail<3>().array();
        const double cutoff = chooseCutoff(coordinates);
        Eigen::MatrixXd first(6, samples), second(6, samples);
        for (int i = 0; i < 6; ++i) {
            const Derivatives derivatives =
                differentiate(smoothZeroPhase(coordinates.row(i).transpose(), interval_, cutoff), interval_);
            first.row(i) = unit[i] * derivatives.first.transpose();
            second.row(i) = unit[i] * derivatives.second.transpose();
        }
        motion.v = first.topRows(3);
        motion.a = second.topRows(3);
        motion.w.resize(3, samples);
        motion.alpha.resize(3, samples);
        for (Eigen::Index k = 0; k < samples; ++k) {
            const Eigen::Vector3d theta = motion.theta.col(k), rate = first.col(k).tail<3>();
            motion.w.col(k) = calcAngularVelocity(theta, rate);
            motion.alpha.col(k) = calcAngularAcceleration(theta, rate, second.col(k).tail<3>());
        }
        noteDerivatives(cutoff);
    }

    void integrateAccelerations() {
        PartMotion& motion = result_.motion;
        const Eigen::Index samples = acceleration_.channelSet().values.cols();
        chooseIntegrationBand();
        const Eigen::Vector3d rest_vector = vectorFromRotation(rest_.R_GM);
        motion.p = rest_.p_GM.replicate(1, samples);
        motion.theta = rest_vector.replicate(1, samples);
        motion.v = motion.w = Eigen::Matrix3Xd::Zero(3, samples);
        Eigen::Matrix3Xd rate = motion.w;
        Eigen::MatrixXd residuals;
        for (int pass = 0; pass < kMostPasses; ++pass) {
            solveAccelerations(&residuals);
            const Eigen::Matrix3Xd second = calcVectorAccelerations(rate);
            for (int i = 0; i < 3; ++i) {
                const IntegratedSignal integral =
                    integrateTwice(second.row(i).transpose(), interval_, result_.trusted_from);
                motion.theta.row(i) = integral.x.transpose().array() + rest_vector[i];
                rate.row(i) = integral.v.transpose();
            }
            if (!(motion.theta.colwise().norm().maxCoeff() < largest_rotation))
                throw InputError({recording_.file, 0, key()},
                                 "the accelerations integrate to rotations of more than a quarter turn",
                                 "displacements as well, or accelerations without content below the excited band");
            const Eigen::Matrix3Xd w_before = motion.w;
            motion.w = calcAngularVelocities(motion.theta, rate);
            if (hasConverged(w_before)) break;
        }
        motion.acceleration_noise = estimateNoise(acceleration_, residuals, motion.a);
        motion.acceleration_density = findDensity(acceleration_, residuals, motion.acceleration_noise);
        motion.acceleration_calibration =
            calibrate(acceleration_, residuals, motion.acceleration_noise, "acceleration");
        for (int i = 0; i < 3; ++i) {
            const IntegratedSignal integral =
                integrateTwice(motion.a.row(i).transpose(), interval_, result_.trusted_from);
            motion.p.row(i) += integral.x.transpose();
            motion.v.row(i) = integral.v.transpose();
        }
        noteIntegration();
    }

    ContactEdges edges_;
    BodyMotion rest_;
    RigidFit displacement_;
    RigidFit acceleration_;
};

}  // namespace

PartEstimate estimatePart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
                          ContactEdges edges) {
    return SixMotionEstimator(recording, model, part, rest, edges).estimate();
}

bool determinesPart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest) {
    for (const Derivative derivative : {Derivative::displacement, Derivative::velocity, Derivative::acceleration})
        if (RigidFit(collectChannels(recording, model, part, derivative), rest).undetermined().empty()) return true;
    return false;
}

PartEstimate estimateTranslation(const Recording& recording, const Eigen::Matrix3Xd& acceleration,
                                 const BodyMotion& rest) {
    PartEstimate estimate;
    const double lowest = findSweptFrequency(recording).lowest;
    estimate.motion = makeStandstill(rest, acceleration.cols());
    PartMotion& motion = estimate.motion;
    motion.acceleration_measured = true;
    motion.a = acceleration;
    motion.acceleration_noise = motion.displacement_noise = std::nan("");
    estimate.trusted_to = 0.25 / recording.sampleInterval();
    estimate.trusted_from = kIntegrationMargin * lowest;
    if (lowest > 0) {
        for (int i = 0; i < 3; ++i) {
            const IntegratedSignal integral =
                integrateTwice(acceleration.row(i).transpose(), recording.sampleInterval(), estimate.trusted_from);
            motion.p.row(i) += integral.x.transpose();
            motion.v.row(i) = integral.v.transpose();
        }
    }
    estimate.notes.push_back(
        "fixed part: no channels of its own, or too few, it follows the base; base acceleration integrated "
        "twice, zero-phase, which says nothing below " +
        formatHertz(estimate.trusted_from));
    return estimate;
}

PartMotion makeStandstill(const BodyMotion& rest, Eigen::Index samples) {
    PartMotion motion;
    motion.p = rest.p_GM.replicate(1, samples);
    motion.theta = vectorFromRotation(rest.R_GM).replicate(1, samples);
    motion.v = motion.w = motion.a = motion.alpha = Eigen::Matrix3Xd::Zero(3, samples);
    return motion;
}

BodyMotion findFixedRest(const MountModel& model, const StaticEquilibrium& equilibrium) {
    BodyMotion rest;
    if (model.bracket.empty()) return rest;
    const FrameMotion frame =
        Bracket(model.bracket).calcMotion(equilibrium.eta, Eigen::VectorXd::Zero(equilibrium.eta.size()));
    rest.R_GM = frame.R_GF;
    rest.p_GM = frame.p_GF;
    return rest;
}

bool hasChannels(const Recording& recording, Part part) {
    return std::any_of(recording.channels.begin(), recording.channels.end(), [part](const Channel& channel) {
        const auto name = parseChannelName(channel.name);
        return name && name->part == part;
    });
}

}  // namespace wems::identify
