#include "identify/problem/load_wrench.hpp"

#include <Eigen/Geometry>
#include <limits>

#include "models/bryant.hpp"
#include "models/load_gain.hpp"

namespace wems::identify {

Eigen::MatrixXd calcLoad(const OpenLoopRun& run, const MountModel& model) {
    Eigen::MatrixXd load = run.load;
    if (!model.load) return load;
    for (Eigen::Index k = 0; k < load.cols(); ++k)
        load.col(k).array() *=
            calcLoadGains(*model.load, k < run.swept.size() ? run.swept[k] : std::numeric_limits<double>::quiet_NaN())
                .array();
    return load;
}

bool loadsMobilePart(const OpenLoopRun& run, const MountModel& model) {
    return model.load_point && model.load_point->part == Part::mobile && run.load.cols() > 0;
}

Eigen::MatrixXd calcLoadWrench(const OpenLoopRun& run, const LoadPoint& point,
                               const Eigen::Ref<const Eigen::MatrixXd>& load) {
    const auto& R = point.part == Part::mobile ? run.mobile.R : run.fixed.R;
    Eigen::MatrixXd wrench(6, load.cols());
    for (Eigen::Index k = 0; k < load.cols(); ++k) {
        const Eigen::Vector3d force = load.col(k);
        wrench.col(k) << force, (R[k] * point.position).cross(force);
    }
    return wrench;
}

Eigen::Matrix<double, 6, 3> calcLoadArm(const LoadPoint& point) {
    Eigen::Matrix<double, 6, 3> arm;
    arm << Eigen::Matrix3d::Identity(), crossMatrix(point.position);
    return arm;
}

}  // namespace wems::identify
