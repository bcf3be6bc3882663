#include "plugin/base_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wems::plugin {
namespace {
constexpr double longest_step = 1e-3;  // s; three-point Gauss is exact to h^6, so 200 Hz costs less than 1e-6
}

BaseMotion::BaseMotion(const Drive& drive, double duration) : drive_(drive) {
    const auto steps = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(duration / longest_step)));
    step_ = duration / static_cast<double>(steps);
    const bool at_rest = !drive.hasBase() || !(duration > 0);
    nodes_.assign(at_rest ? 1 : steps + 1, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    if (at_rest) return;
    for (std::size_t k = 0; k < steps; ++k) {
        const double t = static_cast<double>(k) * step_;
        nodes_[k + 1] = integrate(nodes_[k], t, t + step_);
    }
    // Straight line through the displacement: x = mean + slope (t − T/2).
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), slope = Eigen::Vector3d::Zero();
    double square = 0;
    for (std::size_t k = 0; k <= steps; ++k) {
        const double s = static_cast<double>(k) * step_ - duration / 2;
        mean += nodes_[k].displacement;
        slope += s * nodes_[k].displacement;
        square += s * s;
    }
    mean /= static_cast<double>(steps + 1);
    slope /= square;
    for (std::size_t k = 0; k <= steps; ++k) {
        const double s = static_cast<double>(k) * step_ - duration / 2;
        nodes_[k].displacement -= mean + slope * s;
        nodes_[k].velocity -= slope;
    }
}

BaseMotion::Value BaseMotion::integrate(const Value& from, double t0, double t1) const {
    const double h = t1 - t0, offset = std::sqrt(0.6) / 2;
    const std::array<double, 3> node{0.5 - offset, 0.5, 0.5 + offset}, weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
    Value to{from.displacement + h * from.velocity, from.velocity};
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d a = drive_.calcBaseAcceleration(t0 + node[i] * h);
        to.velocity += weight[i] * h * a;
        to.displacement += weight[i] * h * h * (1 - node[i]) * a;
    }
    return to;
}

BaseMotion::Value BaseMotion::calcValue(double t) const {
    if (!drive_.hasBase() || t <= 0) return nodes_.front();
    const auto k = static_cast<std::size_t>(t / step_);
    if (k + 1 >= nodes_.size()) return nodes_.back();
    const double t0 = static_cast<double>(k) * step_;
    return integrate(nodes_[k], t0, t);
}

}  // namespace wems::plugin
