#include "tests/hidden/truth_simulator.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "models/bracket.hpp"
#include "models/excitation.hpp"
#include "models/load_gain.hpp"
#include "models/mount_forces.hpp"

namespace wems::hidden {
namespace {

constexpr int kSteps = 4;  // of the integrator in a sample

/// State: CoG position and velocity (G), quaternion (w x y z), angular velocity (M), modal coordinates and rates, laws.
class Device {
public:
    Device(const HiddenCase& hidden, const RunPlan& plan)
        : model_(hidden.truth),
          outside_(hidden.outside),
          forces_(hidden.truth),
          bracket_(hidden.truth.bracket),
          force_(plan.direction * plan.level),
          inverse_inertia_(hidden.truth.body.inertia.inverse()) {
        constexpr double lowest = 5, highest = 50;
        sweep_ = makeLogarithmicSweep(plan.upward ? lowest : highest, plan.upward ? highest : lowest,
                                      hidden.octaves_per_minute);
    }

    double duration() const { return sweep_->duration(); }
    Eigen::Vector3d load(double t) const { return force_ * sweep_->value(t); }

    Eigen::VectorXd restState() const {
        Eigen::VectorXd y = Eigen::VectorXd::Zero(13 + 2 * modes() + forces_.stateCount());
        y.head<3>() = model_.body.center_of_gravity;
        y[6] = 1;
        return y;
    }

    BodyMotion body(const Eigen::VectorXd& y) const {
        BodyMotion motion;
        motion.R_GM = Eigen::Quaterniond(y[6], y[7], y[8], y[9]).normalized().toRotationMatrix();
        const Eigen::Vector3d c = motion.R_GM * model_.body.center_of_gravity;
        motion.w_GM = motion.R_GM * y.segment<3>(10);
        motion.p_GM = y.head<3>() - c;
        motion.v_GM = y.segment<3>(3) - motion.w_GM.cross(c);
        return motion;
    }
    FrameMotion frame(const Eigen::VectorXd& y) const {
        return bracket_.calcMotion(y.segment(13, modes()), y.segment(13 + modes(), modes()));
    }
    Bracket::FrameAcceleration frameAcceleration(const Eigen::VectorXd& y, const Eigen::VectorXd& rates) const {
        return bracket_.calcAcceleration(y.segment(13, modes()), y.segment(13 + modes(), modes()),
                                         rates.segment(13 + modes(), modes()));
    }

    Eigen::VectorXd calcRates(const Eigen::VectorXd& y, double t) const {
        Eigen::VectorXd rates = Eigen::VectorXd::Zero(y.size());
        const BodyMotion mobile = body(y);
        const FrameMotion fixed = frame(y);
        Wrench on_mobile, on_fixed;
        forces_.calc(mobile, fixed, t, y.data() + 13 + 2 * modes(), on_mobile, on_fixed,
                     rates.data() + 13 + 2 * modes());
        addOutside(mobile, fixed, t, on_mobile, on_fixed);
        const Eigen::Vector3d c = mobile.R_GM * model_.body.center_of_gravity, w = y.segment<3>(10);
        const Eigen::Vector3d moment = on_mobile.moment - c.cross(on_mobile.force);
        rates.head<3>() = y.segment<3>(3);
        rates.segment<3>(3) = on_mobile.force / model_.body.mass;
        const Eigen::Quaterniond q(y[6], y[7], y[8], y[9]), turn = q * Eigen::Quaterniond(0, w.x(), w.y(), w.z());
        rates.segment<4>(6) << 0.5 * turn.w(), 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z();
        rates.segment<3>(10) =
            inverse_inertia_ * (mobile.R_GM.transpose() * moment - w.cross(model_.body.inertia * w + model_.body.spin));
        const double gain = model_.load ? calcLoadGain(*model_.load, sweep_->frequency(t)) : 1.0;
        rates.segment(13, modes()) = y.segment(13 + modes(), modes());
        Eigen::VectorXd accelerations(modes());
        bracket_.calcAccelerations(y.segment(13, modes()), y.segment(13 + modes(), modes()), on_fixed, gain * load(t),
                                   Eigen::Vector3d::Zero(), accelerations);
        rates.segment(13 + modes(), modes()) = accelerations;
        return rates;
    }

private:
    int modes() const { return bracket_.modeCount(); }

    void addOutside(const BodyMotion& mobile, const FrameMotion& fixed, double t, Wrench& on_mobile,
                    Wrench& on_fixed) const {
        if (outside_.kind == OutsideEffect::Kind::none) return;
        const Eigen::Vector3d r = model_.connections[static_cast<std::size_t>(outside_.connection)].position;
        const Eigen::Vector3d q = calcRelativeMotion(mobile, fixed, r).q;
        const Eigen::Vector3d f = -outside_.calcForce(q, t) * fixed.R_GF.col(outside_.axis);
        on_mobile.force += f;
        on_mobile.moment += (mobile.R_GM * r).cross(f);
        if (outside_.kind == OutsideEffect::Kind::disturbance) return;
        const Eigen::Vector3d point = mobile.p_GM + mobile.R_GM * r - fixed.p_GF;
        on_fixed.force -= f;
        on_fixed.moment -= point.cross(f);
    }

    MountModel model_;
    OutsideEffect outside_;
    MountForces forces_;
    Bracket bracket_;
    Eigen::Vector3d force_;
    Eigen::Matrix3d inverse_inertia_;
    std::unique_ptr<Signal> sweep_;
};

}  // namespace

Markers simulateTruth(const HiddenCase& hidden, std::size_t run) {
    const Device device(hidden, hidden.runs[run]);
    const auto samples = static_cast<int>(device.duration() * hidden.rate);
    const auto rows = 3 * static_cast<Eigen::Index>(hidden.truth.connections.size());
    Markers markers;
    for (auto* m : {&markers.mobile, &markers.fixed, &markers.mobile_acceleration, &markers.fixed_acceleration})
        m->resize(rows, samples);
    markers.load.resize(3, samples);
    Eigen::VectorXd y = device.restState();
    const double h = 1 / hidden.rate / kSteps;
    for (int k = 0; k < samples; ++k) {
        const double t = k / hidden.rate;
        const Eigen::VectorXd rates = device.calcRates(y, t);
        const BodyMotion mobile = device.body(y);
        const FrameMotion fixed = device.frame(y);
        const auto base = device.frameAcceleration(y, rates);
        const Eigen::Vector3d w = mobile.w_GM, alpha = mobile.R_GM * rates.segment<3>(10);
        const Eigen::Vector3d c = mobile.R_GM * hidden.truth.body.center_of_gravity;
        const Eigen::Vector3d a = rates.segment<3>(3) - alpha.cross(c) - w.cross(w.cross(c));
        markers.time.push_back(t);
        markers.load.col(k) = device.load(t);
        for (std::size_t i = 0; i < hidden.truth.connections.size(); ++i) {
            const auto row = 3 * static_cast<Eigen::Index>(i);
            const Eigen::Vector3d r = hidden.truth.connections[i].position;
            const Eigen::Vector3d m = mobile.R_GM * r, f = fixed.R_GF * r;
            markers.mobile.block<3, 1>(row, k) = mobile.p_GM + m - r;
            markers.fixed.block<3, 1>(row, k) = fixed.p_GF + f - r;
            markers.mobile_acceleration.block<3, 1>(row, k) = a + alpha.cross(m) + w.cross(w.cross(m));
            markers.fixed_acceleration.block<3, 1>(row, k) =
                base.linear + base.angular.cross(f) + fixed.w_GF.cross(fixed.w_GF.cross(f));
        }
        for (int s = 0; s < kSteps; ++s) {
            const double at = t + s * h;
            const Eigen::VectorXd k1 = device.calcRates(y, at), k2 = device.calcRates(y + 0.5 * h * k1, at + 0.5 * h),
                                  k3 = device.calcRates(y + 0.5 * h * k2, at + 0.5 * h),
                                  k4 = device.calcRates(y + h * k3, at + h);
            y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
        if (!y.allFinite()) throw TruthDiverged();
    }
    return markers;
}

}  // namespace wems::hidden
