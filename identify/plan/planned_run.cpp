#include "identify/plan/planned_run.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/axis_names.hpp"
#include "models/format_number.hpp"

namespace wems::identify {
namespace {

/// Each axis that is driven, as `x` and its level.
template <typename Function>
std::vector<std::string> listLevels(const Eigen::Vector3d& level, const Function& format) {
    std::vector<std::string> words;
    for (int axis = 0; axis < 3; ++axis)
        if (level[axis] != 0) words.push_back(format(std::string(kAxes[axis]), formatNumber(level[axis])));
    return words;
}

std::string quoteForShell(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string("_-./+:,=@%").find(c) < 20;
    });
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

}  // namespace

double PlannedRun::duration() const {
    return 60 * std::abs(std::log2(to / from)) / octaves_per_minute;
}

std::string describe(const PlannedRun& candidate) {
    const bool load = candidate.excitation == Excitation::load;
    const std::string unit = load ? " N" : " m/s^2";
    const auto levels = listLevels(candidate.level, [&](const std::string& axis, const std::string& value) {
        std::string word = axis;
        return word.append(" ").append(value).append(unit);
    });
    const SensorKinds& sensors = candidate.sensors;
    return std::string(candidate.to > candidate.from ? "sweep up" : "sweep down") + " from " +
           formatNumber(candidate.from) + " to " + formatNumber(candidate.to) + " Hz at " +
           formatNumber(candidate.octaves_per_minute) + " octaves per minute (" +
           formatNumber(candidate.duration(), 3) + " s), " + (load ? "force " : "base acceleration ") +
           joinWords(levels, " and ") + ", recorded as " +
           (sensors.displacement ? sensors.acceleration ? "displacements and accelerations" : "displacements"
                                 : "accelerations") +
           " at " + formatNumber(candidate.sample_rate) + " Hz";
}

std::string formatCommand(const PlannedRun& candidate, const std::string& model_file) {
    const auto levels = listLevels(
        candidate.level, [](std::string axis, const std::string& value) { return axis.append("=").append(value); });
    return "simulate " + quoteForShell(model_file) + " --sweep " + formatNumber(candidate.from) + ":" +
           formatNumber(candidate.to) + " --rate " + formatNumber(candidate.octaves_per_minute) +
           (candidate.excitation == Excitation::load ? " --force " : " --base-acceleration ") + joinWords(levels, ",") +
           " --sample-rate " + formatNumber(candidate.sample_rate) + " -o next.csv";
}

double roundDown(double value, int digits) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - digits + 1);
    // What is such a number already may lie below it by rounding; dividing by a whole power keeps decimals short.
    const double whole = std::floor(value / unit * (1 + 1e-12));
    return unit >= 1 ? whole * unit : whole / std::round(1 / unit);
}

}  // namespace wems::identify
