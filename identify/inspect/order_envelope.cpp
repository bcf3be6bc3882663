#include <algorithm>
#include <cmath>

#include "identify/inspect/order_tracking.hpp"

namespace wems::identify {
namespace {

constexpr double bands_a_decade = 100;

}  // namespace

void OrderEnvelope::add(const OrderTracking& block) {
    if (block.tracks.empty()) return;
    if (channels_.empty()) {
        reference_ = block.reference;
        for (const OrderTrack& track : block.tracks) channels_.push_back(track.channel);
    }
    if (block.reference != reference_ || block.tracks.size() != channels_.size()) return;
    const auto reference =
        std::find(channels_.begin(), channels_.end(), reference_) - channels_.begin();  // the end without one
    for (std::size_t p = 0; p < block.time.size(); ++p) {
        const Eigen::Index column = p;
        const auto& drive = block.tracks[reference_.empty() ? 0 : static_cast<std::size_t>(reference)];
        const double level = drive.amplitude(0, column);
        if (!(level > 0)) continue;  // nor where there is none
        Point& point = points_[std::lround(bands_a_decade * std::log10(block.hertz[p]))];
        if (!(level > point.level)) continue;
        const Eigen::Index count = block.tracks.size();
        point = {block.time[p], block.hertz[p], Eigen::MatrixXd(tracked_orders, count),
                 Eigen::MatrixXd(tracked_orders, count), level};
        for (Eigen::Index c = 0; c < count; ++c) {
            const OrderTrack& track = block.tracks[c];
            point.amplitude.col(c) = track.amplitude.col(column);
            point.phase.col(c) = track.phase.col(column);
        }
    }
}

OrderTracking OrderEnvelope::finish() const {
    OrderTracking result;
    result.reference = reference_;
    const Eigen::Index count = points_.size();
    for (const auto& name : channels_)
        result.tracks.push_back({name, Eigen::MatrixXd(tracked_orders, count), Eigen::MatrixXd(tracked_orders, count)});
    Eigen::Index p = 0;
    for (const auto& [band, point] : points_) {
        result.time.push_back(point.time);
        result.hertz.push_back(point.hertz);
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            result.tracks[c].amplitude.col(p) = point.amplitude.col(c);
            result.tracks[c].phase.col(p) = point.phase.col(c);
        }
        ++p;
    }
    return result;
}

}  // namespace wems::identify
