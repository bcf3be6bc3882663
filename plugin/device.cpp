#include "plugin/device.hpp"

#include <utility>

#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/guided_motion.hpp"
#include "models/mount_forces.hpp"

namespace wems::plugin {
namespace {

const MountModel& checked(const MountModel& model, const Drive* drive) {
    validate(model);
    if (drive != nullptr && drive->hasLoad() && !loadActs(model))
        throw InputError({"", 0, "load"}, "the model has no bracket, so that a force on the fixed part moves nothing",
                         "a base acceleration, a model with [bracket], or [load] part = \"mobile\"");
    return model;
}

}  // namespace

Device::Device(const MountModel& model, std::shared_ptr<const Drive> drive, double duration)
    : model_(checked(model, drive.get())),
      drive_(std::move(drive)),
      rest_(findStaticEquilibrium(model_)),
      matter_(system_),
      forces_(system_),
      body_(matter_.updGround(), SimTK::Transform(), SimTK::Body::Rigid(makeMassProperties(model_.body)),
            SimTK::Transform()),
      force_(forces_, body_, model_, drive_) {
    if (model_.bracket.empty()) {
        const GuidedMotion guide(model_.body);
        for (const int i : guide.held())  // the mobilizer has its angles first
            SimTK::Constraint::ConstantCoordinate(body_, SimTK::MobilizerQIndex(i < 3 ? i + 3 : i - 3), 0);
    }
    if (!model_.bracket.empty())
        rest_fixed_ = Bracket(model_.bracket).calcMotion(rest_.eta, Eigen::VectorXd::Zero(rest_.eta.size()));
    if (drive_) base_motion_ = std::make_unique<BaseMotion>(*drive_, duration);
}

SimTK::State Device::makeRestState() {
    SimTK::State state = system_.realizeTopology();
    system_.realizeModel(state);
    body_.setQToFitTransform(state, SimTK::Transform(toSimTK(rest_.mobile.R_GM), toSimTK(rest_.mobile.p_GM)));
    if (!model_.bracket.empty()) force_.setEta(state, rest_.eta, Eigen::VectorXd::Zero(rest_.eta.size()));
    force_.setInternalStates(state, rest_.states);
    return state;
}

DeviceMotion Device::calcMotion(const SimTK::State& state) const {
    system_.realize(state, SimTK::Stage::Acceleration);
    const double t = state.getTime();
    DeviceMotion motion;
    motion.load = drive_ ? drive_->calcLoad(t) : Eigen::Vector3d::Zero();
    motion.base = drive_ ? drive_->calcBaseAcceleration(t) : Eigen::Vector3d::Zero();
    BaseMotion::Value base{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    if (base_motion_) base = base_motion_->calcValue(t);

    const BodyMotion mobile = calcFrameMotion(body_, SimTK::Transform(), state);
    const FrameMotion fixed = force_.calcFixedMotion(state);
    const SimTK::SpatialVec& A_GM = body_.getBodyAcceleration(state);
    const Bracket::FrameAcceleration A_GF = force_.calcFixedAcceleration(state);
    const Eigen::Vector3d alpha_GM = toEigen(A_GM[0]), a_GM = toEigen(A_GM[1]);

    for (const Connection& connection : model_.connections) {
        const Eigen::Vector3d& r = connection.position;
        const Eigen::Vector3d r_M = mobile.R_GM * r, r_F = fixed.R_GF * r;
        motion.mobile.push_back({base.displacement + mobile.p_GM + r_M - (rest_.mobile.p_GM + rest_.mobile.R_GM * r),
                                 base.velocity + mobile.v_GM + mobile.w_GM.cross(r_M),
                                 motion.base + a_GM + alpha_GM.cross(r_M) + mobile.w_GM.cross(mobile.w_GM.cross(r_M))});
        motion.fixed.push_back(
            {base.displacement + fixed.p_GF + r_F - (rest_fixed_.p_GF + rest_fixed_.R_GF * r),
             base.velocity + fixed.v_GF + fixed.w_GF.cross(r_F),
             motion.base + A_GF.linear + A_GF.angular.cross(r_F) + fixed.w_GF.cross(fixed.w_GF.cross(r_F))});
        motion.relative.push_back(calcRelativeMotion(mobile, fixed, r));
    }
    motion.force = force_.calcConnectionForces(state);
    motion.mobile_pose << base.displacement + mobile.p_GM - rest_.mobile.p_GM,
        vectorFromRotation(mobile.R_GM * rest_.mobile.R_GM.transpose());
    motion.fixed_pose << base.displacement + fixed.p_GF - rest_fixed_.p_GF,
        vectorFromRotation(fixed.R_GF * rest_fixed_.R_GF.transpose());
    return motion;
}

double Device::calcTotalEnergy(const SimTK::State& state) const {
    system_.realize(state, SimTK::Stage::Dynamics);
    return system_.calcEnergy(state) + force_.getDissipatedEnergy(state);
}

}  // namespace wems::plugin
