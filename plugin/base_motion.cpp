#include "plugin/base_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wems::plugin {
namespace {

constexpr double kLongestStep = 1e-3;  // s
constexpr double kStepsPerPeriod = 16;

/// From 0 to `duration`, evenly between kinks.
std::vector<double> makeTimes(const Drive& drive, double duration) {
    const double longest = BaseMotion::findLongestStep(drive);
    std::vector<double> ends = drive.kinks();
    ends.push_back(duration);
    std::sort(ends.begin(), ends.end());
    std::vector<double> times{0};
    for (const double end : ends) {
        const double from = times.back(), length = std::min(end, duration) - from;
        if (!(length > 0)) continue;
        const auto steps = std::max<long>(1, std::lround(std::ceil(length / longest)));
        for (long k = 1; k <= steps; ++k)
            times.push_back(from + length * static_cast<double>(k) / static_cast<double>(steps));
    }
    return times;
}

}  // namespace

BaseMotion::BaseMotion(const Drive& drive, double duration) : drive_(drive), times_{0} {
    nodes_.assign(1, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    if (!drive.hasBase() || !(duration > 0)) return;
    times_ = makeTimes(drive, duration);
    const auto start = drive.findBaseStart();
    if (start) nodes_[0] = {start->displacement, start->velocity};
    for (std::size_t k = 0; k + 1 < times_.size(); ++k)
        nodes_.push_back(integrate(nodes_[k], times_[k], times_[k + 1]));
    if (!start) removeDrift();
}

double BaseMotion::findLongestStep(const Drive& drive) {
    return std::min(kLongestStep, 1 / (kStepsPerPeriod * drive.highestFrequency()));
}

void BaseMotion::removeDrift() {
    // Straight line through the displacement, each node weighted by the time that it stands for.
    const auto count = nodes_.size();
    const auto weight = [&](std::size_t k) {
        return 0.5 * (times_[std::min(k + 1, count - 1)] - times_[k > 0 ? k - 1 : 0]);
    };
    const double duration = times_.back(), middle = duration / 2;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), slope = Eigen::Vector3d::Zero();
    double square = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double s = times_[k] - middle;
        mean += weight(k) / duration * nodes_[k].displacement;
        slope += weight(k) * s * nodes_[k].displacement;
        square += weight(k) * s * s;
    }
    slope /= square;
    for (std::size_t k = 0; k < count; ++k) {
        nodes_[k].displacement -= mean + slope * (times_[k] - middle);
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
    if (nodes_.size() < 2 || t <= 0) return nodes_.front();
    if (t >= times_.back()) return nodes_.back();
    const auto k = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin()) - 1;
    return integrate(nodes_[k], times_[k], t);
}

}  // namespace wems::plugin
