#include "tests/hidden/device_motion.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "identify/forward/step_size.hpp"
#include "models/bracket.hpp"
#include "models/mount_forces.hpp"

namespace wems::hidden {
namespace {

using Vector = Eigen::VectorXd;

/// State: CoG position and velocity (G, or relative to the table), quaternion (w x y z), angular velocity (M), modal
/// coordinates and rates, laws.
class Device {
public:
    Device(const HiddenDevice& device, const Drive& drive, Eigen::Index half_steps, double half_step)
        : model_(device.model),
          outside_(device.outside),
          set_up_(device.set_up),
          forces_(device.model),
          bracket_(device.model.bracket),
          modes_(bracket_.modeCount()),
          inverse_inertia_(device.model.body.inertia.inverse()),
          half_step_(half_step) {
        drive_ = resample(drive.values, drive.rate, 1 / half_step, half_steps);
        if (set_up_.loaded() && model_.load) applyGain(drive);
    }

    Vector restState() const {
        Vector y = Vector::Zero(13 + 2 * modes_ + forces_.stateCount());
        y.head<3>() = model_.body.center_of_gravity;
        y[6] = 1;
        return y;
    }
    BodyMotion body(const Vector& y) const {
        BodyMotion motion;
        motion.R_GM = Eigen::Quaterniond(y[6], y[7], y[8], y[9]).normalized().toRotationMatrix();
        const Eigen::Vector3d c = motion.R_GM * model_.body.center_of_gravity;
        motion.w_GM = motion.R_GM * y.segment<3>(10);
        motion.p_GM = y.head<3>() - c;
        motion.v_GM = y.segment<3>(3) - motion.w_GM.cross(c);
        return motion;
    }
    Bracket::Kinematics frame(const Vector& y) const {
        return bracket_.calcKinematics(y.segment(13, modes_), y.segment(13 + modes_, modes_));
    }
    Bracket::FrameAcceleration frameAcceleration(const Vector& y, const Vector& rates) const {
        return bracket_.calcAcceleration(y.segment(13, modes_), y.segment(13 + modes_, modes_),
                                         rates.segment(13 + modes_, modes_));
    }

    void calcRates(const Vector& y, Eigen::Index half, Vector& rates) const {
        const double t = static_cast<double>(half) * half_step_;
        const BodyMotion mobile = body(y);
        const Bracket::Kinematics fixed = frame(y);
        Wrench on_mobile, on_fixed;
        forces_.calc(mobile, fixed.motion, t, y.data() + 13 + 2 * modes_, on_mobile, on_fixed,
                     rates.data() + 13 + 2 * modes_);
        if (outside_.kind != OutsideEffect::Kind::none) addOutside(mobile, fixed.motion, t, on_mobile, on_fixed);
        const Eigen::Vector3d applied = drive_.col(half);
        rates.head<3>() = y.segment<3>(3);
        rates.segment<3>(3) = on_mobile.force / model_.body.mass;
        if (set_up_.baseDriven()) rates.segment<3>(3) -= applied;
        if (set_up_.oneAxis()) {
            if (set_up_.loaded()) rates[5] += applied.z() / model_.body.mass;
            rates[3] = rates[4] = 0;
            rates.segment<7>(6).setZero();
        } else {
            calcTurning(y, mobile, on_mobile, rates);
        }
        rates.segment(13, modes_) = y.segment(13 + modes_, modes_);
        if (modes_ > 0)
            bracket_.calcAccelerations(fixed.jacobian, y.segment(13, modes_), y.segment(13 + modes_, modes_), on_fixed,
                                       applied, Eigen::Vector3d::Zero(), rates.segment(13 + modes_, modes_));
    }

private:
    void applyGain(const Drive& drive) {
        Eigen::RowVectorXd frequency;
        if (drive.frequency.size() > 0)
            frequency = resample(drive.frequency.transpose(), drive.rate, 1 / half_step_, drive_.cols());
        for (Eigen::Index k = 0; k < drive_.cols(); ++k)
            drive_.col(k).array() *= calcLoadGains(*model_.load, frequency.size() > 0 ? frequency[k] : 0.0).array();
    }

    void calcTurning(const Vector& y, const BodyMotion& mobile, const Wrench& on_mobile, Vector& rates) const {
        const Eigen::Vector3d c = mobile.R_GM * model_.body.center_of_gravity, w = y.segment<3>(10);
        const Eigen::Vector3d moment = on_mobile.moment - c.cross(on_mobile.force);
        const Eigen::Quaterniond q(y[6], y[7], y[8], y[9]), turn = q * Eigen::Quaterniond(0, w.x(), w.y(), w.z());
        rates.segment<4>(6) << 0.5 * turn.w(), 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z();
        rates.segment<3>(10) =
            inverse_inertia_ * (mobile.R_GM.transpose() * moment - w.cross(model_.body.inertia * w + model_.body.spin));
    }

    void addOutside(const BodyMotion& mobile, const FrameMotion& fixed, double t, Wrench& on_mobile,
                    Wrench& on_fixed) const {
        const Eigen::Vector3d r = model_.connections[outside_.connection].position;
        const Eigen::Vector3d q = calcRelativeMotion(mobile, fixed, r).q;
        const Eigen::Vector3d f = -outside_.calcForce(q, t) * fixed.R_GF.col(outside_.axis);
        on_mobile.force += f;
        on_mobile.moment += (mobile.R_GM * r).cross(f);
        if (outside_.kind == OutsideEffect::Kind::disturbance) return;
        const Eigen::Vector3d point = mobile.p_GM + mobile.R_GM * r - fixed.p_GF;
        on_fixed.force -= f;
        on_fixed.moment -= point.cross(f);
    }

    const MountModel& model_;
    const OutsideEffect& outside_;
    const SetUp& set_up_;
    MountForces forces_;
    Bracket bracket_;
    Eigen::Index modes_;
    Eigen::Matrix3d inverse_inertia_;
    double half_step_;
    Eigen::Matrix3Xd drive_;  // at all half steps
};

/// What is kept of a run.
class Recorder {
public:
    Recorder(const Device& device, const MountModel& model, const Points* points, Eigen::Index samples)
        : device_(device), model_(model), points_(points) {
        motion_.relative.resize(3 * model.connections.size(), samples);
        if (points == nullptr) return;
        motion_.mobile_displacement.resize(points->mobile_displacement.size(), samples);
        motion_.mobile_acceleration.resize(points->mobile_acceleration.size(), samples);
        motion_.fixed_displacement.resize(points->fixed_displacement.size(), samples);
        motion_.fixed_acceleration.resize(points->fixed_acceleration.size(), samples);
    }

    /// @param rates those of y; only read where points are wanted
    void add(Eigen::Index sample, const Vector& y, const Vector& rates) {
        const BodyMotion mobile = device_.body(y);
        const FrameMotion fixed = device_.frame(y).motion;
        for (std::size_t i = 0; i < model_.connections.size(); ++i)
            motion_.relative.block<3, 1>(3 * i, sample) =
                calcRelativeMotion(mobile, fixed, model_.connections[i].position).q;
        if (points_ == nullptr) return;
        const auto base = device_.frameAcceleration(y, rates);
        const Eigen::Vector3d w = mobile.w_GM, alpha = mobile.R_GM * rates.segment<3>(10);
        const Eigen::Vector3d c = mobile.R_GM * model_.body.center_of_gravity;
        const Eigen::Vector3d a = rates.segment<3>(3) - alpha.cross(c) - w.cross(w.cross(c));
        const auto turn = [](const Eigen::Matrix3d& R, const Eigen::Vector3d& r) { return Eigen::Vector3d(R * r); };
        fill(points_->mobile_displacement, motion_.mobile_displacement, sample,
             [&](const Eigen::Vector3d& r) { return Eigen::Vector3d(mobile.p_GM + turn(mobile.R_GM, r) - r); });
        fill(points_->mobile_acceleration, motion_.mobile_acceleration, sample, [&](const Eigen::Vector3d& r) {
            const Eigen::Vector3d m = turn(mobile.R_GM, r);
            return Eigen::Vector3d(a + alpha.cross(m) + w.cross(w.cross(m)));
        });
        fill(points_->fixed_displacement, motion_.fixed_displacement, sample,
             [&](const Eigen::Vector3d& r) { return Eigen::Vector3d(fixed.p_GF + turn(fixed.R_GF, r) - r); });
        fill(points_->fixed_acceleration, motion_.fixed_acceleration, sample, [&](const Eigen::Vector3d& r) {
            const Eigen::Vector3d f = turn(fixed.R_GF, r);
            return Eigen::Vector3d(base.linear + base.angular.cross(f) + fixed.w_GF.cross(fixed.w_GF.cross(f)));
        });
    }

    DeviceMotion take() { return std::move(motion_); }

private:
    template <class Function>
    static void fill(const Eigen::Matrix3Xd& points, Eigen::MatrixXd& motion, Eigen::Index sample,
                     const Function& calc) {
        for (Eigen::Index i = 0; i < points.cols(); ++i) motion.block<3, 1>(3 * i, sample) = calc(points.col(i));
    }
    const Device& device_;
    const MountModel& model_;
    const Points* points_;
    DeviceMotion motion_;
};

}  // namespace

Drive makeDrive(const RunPlan& plan) {
    return {kTableRate, plan.direction * plan.level * plan.signal.transpose(), plan.frequency};
}

DeviceMotion simulateDevice(const HiddenDevice& device, const Drive& drive, double rate, Eigen::Index samples,
                            double longest_step, const Points* points) {
    const int steps = std::max(static_cast<int>(std::ceil(1 / (rate * longest_step) - 1e-9)),
                               identify::chooseStepsPerSample(device.model, 1 / rate));
    const double h = 1 / rate / steps;
    const Device moving(device, drive, 2 * steps * (samples - 1) + 1, h / 2);
    Recorder recorder(moving, device.model, points, samples);
    Vector y = moving.restState();
    Vector stage = y, k1 = Vector::Zero(y.size()), k2 = k1, k3 = k1, k4 = k1;
    Eigen::Index half = 0;
    for (Eigen::Index k = 0; k < samples; ++k) {
        moving.calcRates(y, half, k1);
        recorder.add(k, y, k1);
        if (!std::isfinite(y.squaredNorm())) throw TruthDiverged();
        if (k + 1 == samples) break;
        for (int s = 0; s < steps; ++s, half += 2) {
            if (s > 0) moving.calcRates(y, half, k1);
            stage = y + (0.5 * h) * k1;
            moving.calcRates(stage, half + 1, k2);
            stage = y + (0.5 * h) * k2;
            moving.calcRates(stage, half + 1, k3);
            stage = y + h * k3;
            moving.calcRates(stage, half + 2, k4);
            y += (h / 6) * (k1 + 2 * (k2 + k3) + k4);
        }
    }
    return recorder.take();
}

}  // namespace wems::hidden
