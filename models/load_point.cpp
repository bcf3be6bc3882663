#include "models/load_point.hpp"

#include <Eigen/Geometry>

namespace wems {

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
