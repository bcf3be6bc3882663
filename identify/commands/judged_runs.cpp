#include "identify/commands/judged_runs.hpp"

#include <algorithm>

#include "identify/diagnose/channel_correction.hpp"
#include "identify/diagnose/slow_motion.hpp"
#include "models/axis_names.hpp"

namespace wems::identify::commands {
namespace {

/// `4.z`, `4.z.+` and the like.
std::optional<AxisPlace> parsePlace(const std::string& place, const MountModel& model) {
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const AxisPlace candidate{i, axis};
            const std::string name = candidate.name(model);
            if (place == name || place.rfind(name + ".", 0) == 0) return candidate;
        }
    return std::nullopt;
}

}  // namespace

std::string AxisPlace::name(const MountModel& model) const {
    return model.connections[connection].name + "." + kAxes[axis];
}

std::vector<JudgedRun> prepareJudgedRuns(const std::vector<Recording>& recordings, const Diagnosis& diagnosis,
                                         std::size_t most) {
    std::vector<JudgedRun> runs;
    for (std::size_t r = 0; r < std::min(most, recordings.size()); ++r) {
        JudgedRun run{correctChannels(recordings[r], diagnosis.extended.sensors), {}};
        run.motion = estimateMotion(run.recording, diagnosis.extended);
        restoreSlowMotion(run.motion, diagnosis.extended);
        runs.push_back(std::move(run));
    }
    return runs;
}

std::optional<AxisPlace> findNamedAxis(const Diagnosis& diagnosis) {
    std::vector<std::string> places;
    for (const Cause& cause : diagnosis.causes) places.insert(places.end(), cause.where.begin(), cause.where.end());
    places.insert(places.end(), diagnosis.unexplained_where.begin(), diagnosis.unexplained_where.end());
    for (const std::string& place : places)
        if (const auto axis = parsePlace(place, diagnosis.extended)) return axis;
    return std::nullopt;
}

}  // namespace wems::identify::commands
