#include "plugin/device_force.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/common/error.hpp"
#include "models/guided_motion.hpp"
#include "models/mount_forces.hpp"
#include "plugin/mount_force.hpp"

namespace wems::plugin {
namespace {

using ConstMap = Eigen::Map<const Eigen::VectorXd>;
using Map = Eigen::Map<Eigen::VectorXd>;

/// What a model says, as the force needs it.
struct DeviceValues {
    explicit DeviceValues(const MountModel& model)
        : laws(model),
          bracket(model.bracket),
          gravity(model.gravity),
          spin(model.body.spin),
          load(model.load.value_or(LoadCorrection{})),
          load_point(model.load_point),
          body(model.body),
          guide(model.body) {}
    MountForces laws;
    Bracket bracket;
    Eigen::Vector3d gravity, spin;
    LoadCorrection load;
    std::optional<LoadPoint> load_point;
    MobileBody body;
    GuidedMotion guide;  // of a part held relative to a bracket that moves; otherwise the device has constraints
};

/// z holds η, η', the laws' internal states, the dissipated energy.
class DeviceForceImplementation : public SimTK::Force::Custom::Implementation {
public:
    DeviceForceImplementation(const SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& mobile,
                              const DeviceValues& values, const MobileBody& body, std::shared_ptr<const Drive> drive)
        : mobile_(mobile),
          mass_(body.mass),
          p_MC_(body.center_of_gravity),
          drive_(std::move(drive)),
          modes_(values.bracket.modeCount()),
          state_(forces, values, 2 * modes_ + values.laws.stateCount() + 1) {}

    void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                   SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector&) const override {
        const DeviceValues& values = state_.getValues(state);
        const double t = state.getTime();
        const double* z = state_.getZ(state);
        double* zdot = state_.updDerivatives(state);
        const BodyMotion mobile = calcFrameMotion(mobile_, SimTK::Transform(), state);
        const FrameMotion fixed = calcFixedMotion(state);

        askWatch(t);
        checkPose(mobile, fixed, t);
        Wrench on_mobile, on_fixed;
        values.laws.calc(mobile, fixed, t, z + 2 * modes_, on_mobile, on_fixed, zdot + 2 * modes_);
        double power = values.laws.calcDissipatedPower(mobile, fixed, t, z + 2 * modes_);

        Eigen::Vector3d load = Eigen::Vector3d::Zero(), base = Eigen::Vector3d::Zero();
        if (drive_) {
            base = drive_->calcBaseAcceleration(t);
            if (drive_->hasLoad())
                load = calcLoadGains(values.load, drive_->calcFrequency(t)).cwiseProduct(drive_->calcLoad(t));
        }
        load = applyLoad(values.load_point, mobile, fixed, load, on_mobile, on_fixed);
        if (modes_ > 0) {
            const ConstMap eta(z, modes_), eta_dot(z + modes_, modes_);
            Map(zdot, modes_) = eta_dot;
            Map eta_dot_dot(zdot + modes_, modes_);
            values.bracket.calcAccelerations(eta, eta_dot, on_fixed, load, base, eta_dot_dot);
            power += values.bracket.calcDissipatedPower(eta_dot);
        }
        zdot[energyIndex()] = power;

        const Eigen::Vector3d weight = mass_ * (values.gravity - base);
        on_mobile.force += weight;
        on_mobile.moment += (mobile.R_GM * p_MC_).cross(weight);
        if (modes_ > 0 && values.guide.active())
            guide(values, mobile, fixed, z, zdot, on_mobile);
        else
            on_mobile.moment -= mobile.w_GM.cross(mobile.R_GM * values.spin);
        checkFinite(on_mobile, zdot, t);
        state_.markDerivatives(state);
        body_forces[mobile_.getMobilizedBodyIndex()] += toSimTK(on_mobile);
    }

    SimTK::Real calcPotentialEnergy(const SimTK::State& state) const override {
        const DeviceValues& values = state_.getValues(state);
        const BodyMotion mobile = calcFrameMotion(mobile_, SimTK::Transform(), state);
        const double* z = state_.getZ(state);
        const Eigen::Vector3d p_GC = mobile.p_GM + mobile.R_GM * p_MC_;
        return values.laws.calcPotential(mobile, calcFixedMotion(state), state.getTime(), z + 2 * modes_) +
               values.bracket.calcEnergy(ConstMap(z, modes_), ConstMap(z + modes_, modes_)) -
               mass_ * values.gravity.dot(p_GC);
    }

    void realizeTopology(SimTK::State& state) const override { state_.allocate(state); }
    void realizeAcceleration(const SimTK::State& state) const override { state_.publishDerivatives(state); }

    FrameMotion calcFixedMotion(const SimTK::State& state) const {
        if (modes_ == 0) return {};
        const double* z = state_.getZ(state);
        return state_.getValues(state).bracket.calcMotion(ConstMap(z, modes_), ConstMap(z + modes_, modes_));
    }

    Eigen::Matrix3Xd calcConnectionForces(const SimTK::State& state) const {
        return state_.getValues(state).laws.calcConnectionForces(calcFrameMotion(mobile_, SimTK::Transform(), state),
                                                                 calcFixedMotion(state), state.getTime(),
                                                                 state_.getZ(state) + 2 * modes_);
    }

    const ElementState<DeviceValues>& elementState() const { return state_; }
    int modeCount() const { return modes_; }
    int lawStateCount() const { return state_.count() - 2 * modes_ - 1; }
    int energyIndex() const { return state_.count() - 1; }
    const std::string& failure() const { return failure_; }
    void setWatch(std::function<std::string(double)> watch) const { watch_ = std::move(watch); }

private:
    /// Adds the reactions of the guides: to the wrench on the mobile part, and to the modal accelerations in zdot.
    void guide(const DeviceValues& values, const BodyMotion& mobile, const FrameMotion& fixed, const double* z,
               double* zdot, Wrench& on_mobile) const {
        constexpr double stabilization = 200;  // 1/s, slow against the integrator's steps, fast against a run
        const ConstMap eta(z, modes_), eta_dot(z + modes_, modes_);
        const Bracket::FrameAcceleration bias =
            values.bracket.calcAcceleration(eta, eta_dot, Eigen::VectorXd::Zero(modes_));
        Vector6 frame_bias;
        frame_bias << bias.linear, bias.angular;
        const Eigen::Vector3d arm = mobile.R_GM * values.body.center_of_gravity;
        const Vector6 acceleration = values.guide.calcAcceleration(
            mobile, fixed, frame_bias, {on_mobile.moment - arm.cross(on_mobile.force), on_mobile.force},
            values.bracket.calcFrameJacobian(values.bracket.calcKinematics(eta, eta_dot).jacobian),
            Map(zdot + modes_, modes_), stabilization);
        const Eigen::Matrix3d inertia = mobile.R_GM * values.body.inertia * mobile.R_GM.transpose();
        on_mobile.force = values.body.mass * acceleration.head<3>();
        on_mobile.moment =
            inertia * acceleration.tail<3>() + mobile.w_GM.cross(inertia * mobile.w_GM) + arm.cross(on_mobile.force);
    }

    void askWatch(double t) const {
        constexpr long calls_between = 256;  // a few milliseconds
        if (watch_ && stopped_.empty() && ++calls_ % calls_between == 0) stopped_ = watch_(t);
        if (stopped_.empty()) return;
        failure_ = stopped_;
        throw DeviceFailure(failure_);
    }

    // The integrator answers an exception with a shorter step, so that a wild trial step does no harm; where every step
    // fails it gives up, and the last reason kept here is the one to tell.
    [[noreturn]] void fail(double t, const char* reason) const {
        char text[160];
        std::snprintf(text, sizeof text, "%s at t = %.6g s", reason, t);
        failure_ = text;
        throw DeviceFailure(failure_);
    }

    void checkPose(const BodyMotion& mobile, const FrameMotion& fixed, double t) const {
        constexpr double largest_separation = 1;  // m
        constexpr double largest_sine = 0.99;     // of the middle Bryant angle, singular at one
        if (!((mobile.p_GM - fixed.p_GF).norm() < largest_separation)) fail(t, "the parts are more than 1 m apart");
        if (!(std::abs(mobile.R_GM(0, 2)) < largest_sine))
            fail(t, "the mobile part has turned by more than 80 degrees");
    }

    void checkFinite(const Wrench& on_mobile, const double* zdot, double t) const {
        if (on_mobile.force.allFinite() && on_mobile.moment.allFinite() && ConstMap(zdot, state_.count()).allFinite())
            return;
        fail(t, "the forces are no longer finite");
    }

    SimTK::MobilizedBody mobile_;
    double mass_;
    Eigen::Vector3d p_MC_;
    std::shared_ptr<const Drive> drive_;
    int modes_;
    ElementState<DeviceValues> state_;
    mutable std::string failure_;  // the integrator swallows what calcForce throws
    mutable std::function<std::string(double)> watch_;
    mutable long calls_ = 0;
    mutable std::string stopped_;  // why the watch ended the run
};

const DeviceForceImplementation& getDevice(const SimTK::Force::Custom::Implementation& implementation) {
    return static_cast<const DeviceForceImplementation&>(implementation);
}

}  // namespace

DeviceForce::DeviceForce(SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& mobile,
                         const MountModel& model, std::shared_ptr<const Drive> drive)
    : SimTK::Force::Custom(
          forces, new DeviceForceImplementation(forces, mobile, DeviceValues(model), model.body, std::move(drive))) {}

void DeviceForce::setModel(SimTK::State& state, const MountModel& model) const {
    validate(model);
    const auto& device = getDevice(getImplementation());
    DeviceValues values(model);
    const DeviceValues& old = device.elementState().defaults();
    if (values.laws.connectionCount() != old.laws.connectionCount() ||
        values.laws.stateCount() != old.laws.stateCount() || values.bracket.modeCount() != old.bracket.modeCount())
        throw InputError({}, "the new model has another number of connections, internal states or bracket modes",
                         "other values in the same model");
    device.elementState().updValues(state) = std::move(values);
}

int DeviceForce::modeCount() const {
    return getDevice(getImplementation()).modeCount();
}

Eigen::VectorXd DeviceForce::getEta(const SimTK::State& state) const {
    return ConstMap(getDevice(getImplementation()).elementState().getZ(state), modeCount());
}

Eigen::VectorXd DeviceForce::getEtaDot(const SimTK::State& state) const {
    return ConstMap(getDevice(getImplementation()).elementState().getZ(state) + modeCount(), modeCount());
}

Eigen::VectorXd DeviceForce::getEtaDotDot(const SimTK::State& state) const {
    return ConstMap(getDevice(getImplementation()).elementState().getZDot(state) + modeCount(), modeCount());
}

void DeviceForce::setEta(SimTK::State& state, const Eigen::VectorXd& eta, const Eigen::VectorXd& eta_dot) const {
    double* z = getDevice(getImplementation()).elementState().updZ(state);
    Map(z, modeCount()) = eta;
    Map(z + modeCount(), modeCount()) = eta_dot;
}

void DeviceForce::setInternalStates(SimTK::State& state, const Eigen::VectorXd& states) const {
    const auto& device = getDevice(getImplementation());
    Map(device.elementState().updZ(state) + 2 * modeCount(), device.lawStateCount()) = states;
}

FrameMotion DeviceForce::calcFixedMotion(const SimTK::State& state) const {
    return getDevice(getImplementation()).calcFixedMotion(state);
}

Bracket::FrameAcceleration DeviceForce::calcFixedAcceleration(const SimTK::State& state) const {
    if (modeCount() == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    const auto& device = getDevice(getImplementation());
    return device.elementState().getValues(state).bracket.calcAcceleration(getEta(state), getEtaDot(state),
                                                                           getEtaDotDot(state));
}

Eigen::Matrix3Xd DeviceForce::calcConnectionForces(const SimTK::State& state) const {
    return getDevice(getImplementation()).calcConnectionForces(state);
}

double DeviceForce::getDissipatedEnergy(const SimTK::State& state) const {
    const auto& device = getDevice(getImplementation());
    return device.elementState().getZ(state)[device.energyIndex()];
}

void DeviceForce::setWatch(std::function<std::string(double)> watch) const {
    getDevice(getImplementation()).setWatch(std::move(watch));
}

const std::string& DeviceForce::failure() const {
    return getDevice(getImplementation()).failure();
}

}  // namespace wems::plugin
