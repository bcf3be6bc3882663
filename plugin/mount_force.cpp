#include "plugin/mount_force.hpp"

#include <string>

#include "models/common/error.hpp"

namespace wems::plugin {

namespace {

class MountForceImplementation : public SimTK::Force::Custom::Implementation {
public:
    MountForceImplementation(const SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& fixed,
                             const SimTK::Transform& X_FixedF, const SimTK::MobilizedBody& mobile,
                             const SimTK::Transform& X_MobileM, const MountModel& model)
        : fixed_(fixed),
          mobile_(mobile),
          X_FixedF_(X_FixedF),
          X_MobileM_(X_MobileM),
          state_(forces, makeLaws(model), MountForces(model).stateCount() + 1) {
        for (const Connection& connection : model.connections) positions_.push_back(connection.position);
    }

    // Simbody calls these by its own rules and swallows what they throw: whatever can be wrong with the laws is
    // checked before, in makeLaws.
    void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                   SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector&) const override {
        const BodyMotion mobile = calcMobileMotion(state);
        const FrameMotion fixed = calcFixedMotion(state);
        const MountForces& laws = state_.getValues(state);
        Wrench on_mobile, on_fixed;
        double* zdot = state_.updDerivatives(state);
        laws.calc(mobile, fixed, state.getTime(), state_.getZ(state), on_mobile, on_fixed, zdot);
        zdot[energyIndex()] = laws.calcDissipatedPower(mobile, fixed, state.getTime(), state_.getZ(state));
        state_.markDerivatives(state);
        addWrench(on_mobile, mobile_, X_MobileM_, state, body_forces);
        addWrench(on_fixed, fixed_, X_FixedF_, state, body_forces);
    }

    SimTK::Real calcPotentialEnergy(const SimTK::State& state) const override {
        return state_.getValues(state).calcPotential(calcMobileMotion(state), calcFixedMotion(state), state.getTime(),
                                                     state_.getZ(state));
    }

    void realizeTopology(SimTK::State& state) const override { state_.allocate(state); }
    void realizeAcceleration(const SimTK::State& state) const override { state_.publishDerivatives(state); }

    static MountForces makeLaws(const MountModel& model) {
        for (std::size_t i = 0; i < model.connections.size(); ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (const auto problem = findProblem(model.connections[i].axis[axis])) {
                    const std::string key = "connection[" + std::to_string(i) + "]." + "xyz"[axis] + "." + problem->key;
                    throw InputError({"", 0, key}, problem->problem, problem->accepted);
                }
            }
        }
        return MountForces(model);
    }

    BodyMotion calcMobileMotion(const SimTK::State& state) const { return calcFrameMotion(mobile_, X_MobileM_, state); }
    FrameMotion calcFixedMotion(const SimTK::State& state) const {
        const BodyMotion motion = calcFrameMotion(fixed_, X_FixedF_, state);
        return {motion.R_GM, motion.p_GM, motion.w_GM, motion.v_GM};
    }

    const ElementState<MountForces>& elementState() const { return state_; }
    const std::vector<Eigen::Vector3d>& positions() const { return positions_; }
    int energyIndex() const { return state_.count() - 1; }

private:
    static void addWrench(const Wrench& wrench, const SimTK::MobilizedBody& body, const SimTK::Transform& X_BP,
                          const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces) {
        const SimTK::Vec3 p_BP_G = body.getBodyRotation(state) * X_BP.p();
        const SimTK::SpatialVec at_point = toSimTK(wrench);
        body_forces[body.getMobilizedBodyIndex()] += SimTK::SpatialVec(at_point[0] + p_BP_G % at_point[1], at_point[1]);
    }

    SimTK::MobilizedBody fixed_, mobile_;
    SimTK::Transform X_FixedF_, X_MobileM_;
    ElementState<MountForces> state_;
    std::vector<Eigen::Vector3d> positions_;
};

const MountForceImplementation& getMount(const SimTK::Force::Custom::Implementation& implementation) {
    return static_cast<const MountForceImplementation&>(implementation);
}

}  // namespace

MountForce::MountForce(SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& fixed,
                       const SimTK::Transform& X_FixedF, const SimTK::MobilizedBody& mobile,
                       const SimTK::Transform& X_MobileM, const MountModel& model)
    : SimTK::Force::Custom(forces, new MountForceImplementation(forces, fixed, X_FixedF, mobile, X_MobileM, model)) {}

int MountForce::connectionCount() const {
    return static_cast<int>(getMount(getImplementation()).positions().size());
}

const MountForces& MountForce::getLaws(const SimTK::State& state) const {
    return getMount(getImplementation()).elementState().getValues(state);
}

void MountForce::setLaws(SimTK::State& state, const MountModel& model) const {
    const auto& mount = getMount(getImplementation());
    MountForces laws = MountForceImplementation::makeLaws(model);
    bool same_connections = model.connections.size() == mount.positions().size();
    for (std::size_t i = 0; same_connections && i < model.connections.size(); ++i)
        same_connections = model.connections[i].position == mount.positions()[i];
    if (!same_connections)
        throw InputError({"", 0, "connection"}, "the element was made with other connections",
                         "the same number at the same positions");
    if (laws.stateCount() + 1 != mount.elementState().count())
        throw InputError(
            {"", 0, "connection"}, "the laws have another number of internal states",
            "a change of values, no new branch, slider, loss factor, hysteresis or friction with presliding");
    mount.elementState().updValues(state) = std::move(laws);
}

std::vector<RelativeMotion> MountForce::calcRelativeMotions(const SimTK::State& state) const {
    const auto& mount = getMount(getImplementation());
    const BodyMotion mobile = mount.calcMobileMotion(state);
    const FrameMotion fixed = mount.calcFixedMotion(state);
    std::vector<RelativeMotion> motions;
    for (const Eigen::Vector3d& position : mount.positions())
        motions.push_back(calcRelativeMotion(mobile, fixed, position));
    return motions;
}

Eigen::Matrix3Xd MountForce::calcConnectionForces(const SimTK::State& state) const {
    const auto& mount = getMount(getImplementation());
    const auto& element = mount.elementState();
    return element.getValues(state).calcConnectionForces(mount.calcMobileMotion(state), mount.calcFixedMotion(state),
                                                         state.getTime(), element.getZ(state));
}

double MountForce::getDissipatedEnergy(const SimTK::State& state) const {
    const auto& mount = getMount(getImplementation());
    return mount.elementState().getZ(state)[mount.energyIndex()];
}

void MountForce::setDissipatedEnergy(SimTK::State& state, double energy) const {
    const auto& mount = getMount(getImplementation());
    mount.elementState().updZ(state)[mount.energyIndex()] = energy;
}

double MountForce::calcDissipatedPower(const SimTK::State& state) const {
    const auto& mount = getMount(getImplementation());
    const auto& element = mount.elementState();
    return element.getValues(state).calcDissipatedPower(mount.calcMobileMotion(state), mount.calcFixedMotion(state),
                                                        state.getTime(), element.getZ(state));
}

}  // namespace wems::plugin
