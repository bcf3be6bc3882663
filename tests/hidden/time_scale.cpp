#include "tests/hidden/time_scale.hpp"

namespace wems::hidden {

MountModel slowDown(const MountModel& model, double factor) {
    MountModel slow = model;
    const double force = 1 / (factor * factor);  // N, N/m, N/m², N/m³
    slow.gravity *= force;
    slow.body.spin /= factor;
    for (auto& connection : slow.connections)
        for (auto& law : connection.axis) {
            law.stiffness *= force;
            law.quadratic *= force;
            law.cubic *= force;
            law.damping /= factor;
            law.drift /= factor;
            if (law.relaxation) law.relaxation->time_constant *= factor;
            if (law.friction) {
                law.friction->force *= force;
                law.friction->transition_velocity /= factor;
                if (law.friction->presliding_stiffness) *law.friction->presliding_stiffness *= force;
            }
            if (law.hysteresis) law.hysteresis->force *= force;
            for (auto& stop : law.stops) {
                stop.stiffness *= force;
                stop.dissipation *= factor;
            }
        }
    for (auto& mode : slow.bracket) mode.frequency /= factor;
    if (slow.load)
        for (auto& row : slow.load->gain_over_frequency) row.first /= factor;
    for (auto& sensor : slow.sensors) sensor.delay *= factor;
    return slow;
}

Recording slowDown(Recording recording, double factor) {
    for (double& time : recording.time) time *= factor;
    for (auto& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->derivative == Derivative::displacement) continue;
        for (double& value : channel.values) value /= factor * factor;
    }
    return recording;
}

}  // namespace wems::hidden
