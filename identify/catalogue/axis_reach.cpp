#include "identify/catalogue/axis_reach.hpp"

#include <algorithm>

#include "identify/fit/law_history.hpp"

namespace wems::identify::updating {

AxisReach::AxisReach(const MountModel& model)
    : positive(Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(model.connections.size()))), negative(positive) {}

void AxisReach::widen(const RunMotion& motion, const MountModel& model) {
    const RelativeHistory relative = calcRelativeHistory(motion, model);
    positive = positive.cwiseMax(relative.q.colwise().maxCoeff().transpose());
    negative = negative.cwiseMax(-relative.q.colwise().minCoeff().transpose());
    velocity = std::max(velocity, relative.v.cwiseAbs().maxCoeff());
}

}  // namespace wems::identify::updating
