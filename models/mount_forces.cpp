#include "models/mount_forces.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace wems {

double calcLoadGain(const LoadCorrection& correction, double frequency) {
    const auto& table = correction.gain_over_frequency;
    if (table.empty()) return 1;
    if (table.size() == 1 || frequency <= table.front().first) return table.front().second;
    const auto above =
        std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.first >= frequency; });
    if (above == table.end()) return table.back().second;
    const auto below = std::prev(above);
    const double fraction = (frequency - below->first) / (above->first - below->first);
    return below->second + fraction * (above->second - below->second);
}

Eigen::Vector3d calcLoadGains(const LoadCorrection& correction, double frequency) {
    return calcLoadGain(correction, frequency) * correction.axis_gain;
}

bool dependsOnFrequency(const LoadCorrection& correction) {
    return correction.gain_over_frequency.size() > 1;
}

RelativeMotion calcRelativeMotion(const BodyMotion& mobile, const FrameMotion& fixed, const Eigen::Vector3d& position) {
    const Eigen::Vector3d arm = mobile.R_GM * position;                 // from Mo to the mobile end
    const Eigen::Vector3d from_fixed = mobile.p_GM + arm - fixed.p_GF;  // from Fo to the mobile end
    return {
        fixed.R_GF.transpose() * from_fixed - position,
        fixed.R_GF.transpose() * (mobile.v_GM + mobile.w_GM.cross(arm) - fixed.v_GF - fixed.w_GF.cross(from_fixed))};
}

MountForces::MountForces(const MountModel& model) {
    positions_.reserve(model.connections.size());
    axes_.reserve(3 * model.connections.size());
    for (const Connection& connection : model.connections) {
        positions_.push_back(connection.position);
        for (const AxisLaw& law : connection.axis) {
            state_offsets_.push_back(state_count_);
            state_count_ += axes_.emplace_back(law).stateCount();
        }
    }
}

namespace {

std::size_t axisNumber(int connection, int axis_index) {
    return 3 * static_cast<std::size_t>(connection) + static_cast<std::size_t>(axis_index);
}

}  // namespace

const AxisForce& MountForces::axis(int connection, int axis_index) const {
    return axes_[axisNumber(connection, axis_index)];
}

AxisForce& MountForces::updAxis(int connection, int axis_index) {
    return axes_[axisNumber(connection, axis_index)];
}

int MountForces::stateOffset(int connection, int axis_index) const {
    return state_offsets_[axisNumber(connection, axis_index)];
}

void MountForces::calc(const BodyMotion& mobile, const FrameMotion& fixed, double t, const double* z, Wrench& on_mobile,
                       Wrench& on_fixed, double* zdot) const {
    // All in F, where laws and sums need no rotation of their own: motion of M relative to F as seen from F.
    const Eigen::Vector3d p_FoMo_G = mobile.p_GM - fixed.p_GF;
    const Eigen::Matrix3d R_FM = fixed.R_GF.transpose() * mobile.R_GM;
    const Eigen::Vector3d p_FM = fixed.R_GF.transpose() * p_FoMo_G;
    const Eigen::Vector3d w_FM = fixed.R_GF.transpose() * (mobile.w_GM - fixed.w_GF);
    const Eigen::Vector3d v_FM = fixed.R_GF.transpose() * (mobile.v_GM - fixed.v_GF - fixed.w_GF.cross(p_FoMo_G));
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = force;  // on the fixed part, about Mo
    const AxisForce* axis = axes_.data();
    for (const Eigen::Vector3d& position : positions_) {
        const Eigen::Vector3d arm = R_FM * position;
        const Eigen::Vector3d q = p_FM + arm - position;
        const Eigen::Vector3d v = v_FM + w_FM.cross(arm);
        Eigen::Vector3d f;
        for (int k = 0; k < 3; ++k, ++axis) {
            f[k] = axis->calcForce(q[k], v[k], t, z);
            if (const int states = axis->stateCount(); states > 0) {
                if (zdot != nullptr) {
                    axis->calcStateDerivative(q[k], v[k], z, zdot);
                    zdot += states;
                }
                z += states;
            }
        }
        force += f;
        moment += arm.cross(f);
    }
    on_fixed.force = fixed.R_GF * force;
    on_mobile.force = -on_fixed.force;
    const Eigen::Vector3d about_mobile = fixed.R_GF * moment;
    on_mobile.moment = -about_mobile;
    on_fixed.moment = about_mobile + p_FoMo_G.cross(on_fixed.force);
}

Eigen::Matrix3Xd MountForces::calcConnectionForces(const BodyMotion& mobile, const FrameMotion& fixed, double t,
                                                   const double* z) const {
    Eigen::Matrix3Xd forces(3, connectionCount());
    for (int i = 0; i < connectionCount(); ++i) {
        const RelativeMotion motion = calcRelativeMotion(mobile, fixed, positions_[i]);
        for (int k = 0; k < 3; ++k) {
            forces(k, i) = axis(i, k).calcForce(motion.q[k], motion.v[k], t, z ? z + stateOffset(i, k) : nullptr);
        }
    }
    return forces;
}

double MountForces::calcPotential(const BodyMotion& mobile, const FrameMotion& fixed, double t, const double* z) const {
    double energy = 0;
    for (int i = 0; i < connectionCount(); ++i) {
        const RelativeMotion motion = calcRelativeMotion(mobile, fixed, positions_[i]);
        for (int k = 0; k < 3; ++k) {
            energy += axis(i, k).calcPotential(motion.q[k], t, z ? z + stateOffset(i, k) : nullptr);
        }
    }
    return energy;
}

double MountForces::calcDissipatedPower(const BodyMotion& mobile, const FrameMotion& fixed, double t,
                                        const double* z) const {
    double power = 0;
    for (int i = 0; i < connectionCount(); ++i) {
        const RelativeMotion motion = calcRelativeMotion(mobile, fixed, positions_[i]);
        for (int k = 0; k < 3; ++k) {
            power += axis(i, k).calcDissipatedPower(motion.q[k], motion.v[k], t, z ? z + stateOffset(i, k) : nullptr);
        }
    }
    return power;
}

Eigen::Vector3d applyLoad(const std::optional<LoadPoint>& point, const BodyMotion& mobile, const FrameMotion& fixed,
                          const Eigen::Vector3d& load, Wrench& on_mobile, Wrench& on_fixed) {
    if (!point) return load;
    const bool to_mobile = point->part == Part::mobile;
    Wrench& wrench = to_mobile ? on_mobile : on_fixed;
    const Eigen::Vector3d arm = (to_mobile ? mobile.R_GM : fixed.R_GF) * point->position;
    wrench.force += load;
    wrench.moment += arm.cross(load);
    return Eigen::Vector3d::Zero();
}

bool loadActs(const MountModel& model) {
    return !model.bracket.empty() || (model.load_point && model.load_point->part == Part::mobile);
}

}  // namespace wems
