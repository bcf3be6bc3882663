#include "identify/exact/cause_reports.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/catalogue/hypotheses.hpp"
#include "identify/fit/intervals.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

constexpr double kConvincing = 4.0;    // excess without a cause over that with it, where much is left unexplained
constexpr double kSystematic = 0.002;  // of a value: calibration, smoothing, sampling; half of a 95 % interval
constexpr double kCertain = 0.999;
constexpr double kLargestDecibels = 120.0;  // dB

/// `body.center_of_gravity.z` → `z`, `body.mass` → `mass`, `load.gain` → `gain`; the others as they are.
std::string reportName(const std::string& name) {
    if (name.rfind("body.", 0) == 0 || name.rfind("load.", 0) == 0) return name.substr(name.rfind('.') + 1);
    return name;
}

CauseParameter makeParameter(const std::string& name, double value, double half_width) {
    return {reportName(name), parameterUnit(name), value, value - half_width, value + half_width};
}

double toDecibel(double ratio) {
    if (!(ratio > 0)) return 0;
    return std::clamp(20 * std::log10(ratio), -kLargestDecibels, kLargestDecibels);
}

std::vector<CauseParameter> makeParameters(const Candidate& candidate, const MountModel& model,
                                           const std::vector<double>& half_widths) {
    std::vector<CauseParameter> parameters;
    for (const auto& entry : candidate.fixed)
        parameters.push_back(makeParameter(entry.first, std::numeric_limits<double>::quiet_NaN(), 0));
    // A stop that was missing: clearance first, as results name it.
    for (std::size_t k = candidate.knobs.size(); k-- > 0;) {
        const auto& knob = candidate.knobs[k];
        for (std::size_t i = knob.names.size(); i-- > 0;) {
            const double value = getParameter(model, knob.names[i]);
            const double width =
                half_widths.empty()
                    ? 0
                    : std::hypot(half_widths[k] * (knob.isFactor() ? knob.base[i] : 1.0), kSystematic * value);
            parameters.push_back(makeParameter(knob.names[i], value, width));
        }
    }
    if (candidate.cause != "clearance") std::reverse(parameters.begin(), parameters.end());
    return parameters;
}

/// `mobile.1.a` (a triax of accelerometers) is reported by the name of its connection.
std::string channelName(const std::string& channel) {
    const auto size = channel.size();
    return size > 2 && channel.compare(size - 2, 2, ".a") == 0 ? channel.substr(0, size - 2) : channel;
}

void sortByGain(std::vector<Cause>& causes) {
    std::stable_sort(causes.begin(), causes.end(),
                     [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
}

}  // namespace

void addSensorCause(const ChannelFault& fault, double error_ratio, bool unexplained, std::vector<Cause>& causes) {
    Cause cause;
    cause.cause = fault.cause;
    const bool side = fault.fault.channel.find('.') == std::string::npos;
    cause.probability = unexplained && side && error_ratio < std::sqrt(kConvincing) ? kDoubtful : kCertain;
    cause.gain_db = toDecibel(error_ratio);
    const std::string channel = channelName(fault.fault.channel);
    cause.where = {channel};
    const double quantile = studentQuantile95(1e6);
    if (fault.cause == "sensor_gain") {
        cause.parameters = {makeParameter(channel + ".gain", fault.fault.gain, quantile * fault.gain_error)};
    } else if (fault.cause == "sensor_delay") {
        cause.parameters = {makeParameter(channel + ".delay", fault.fault.delay, quantile * fault.delay_error)};
    } else {
        for (int a = 0; a < 3; ++a)
            cause.parameters.push_back(
                makeParameter(channel + ".r" + "xyz"[a], fault.fault.rotation[a], quantile * fault.rotation_error));
    }
    const auto known =
        std::find_if(causes.begin(), causes.end(), [&](const Cause& c) { return c.cause == cause.cause; });
    if (known == causes.end()) {
        causes.push_back(cause);
    } else if (std::find(known->where.begin(), known->where.end(), channel) == known->where.end()) {
        known->where.push_back(channel);
        known->parameters.insert(known->parameters.end(), cause.parameters.begin(), cause.parameters.end());
        known->gain_db = std::max(known->gain_db, cause.gain_db);
    }
    sortByGain(causes);
}

std::vector<Cause> makeCauseReports(const Selection& selection, const std::vector<Judgement>& without,
                                    const Judgement& after, bool unexplained) {
    std::vector<Cause> causes;
    const double left = std::max(after.misfit - 1, 0.05);
    const double quantile = studentQuantile95(1e6);
    auto error = selection.standard_errors.begin();
    for (std::size_t i = 0; i < selection.accepted.size(); ++i) {
        const auto& candidate = selection.accepted[i];
        std::vector<double> half_widths;
        for (std::size_t k = 0; k < candidate.knobs.size(); ++k) half_widths.push_back(quantile * *error++);
        Cause cause;
        cause.cause = candidate.cause;
        cause.where = candidate.where;
        cause.parameters = makeParameters(candidate, selection.fit.model, half_widths);
        cause.gain_db = toDecibel(without[i].error / after.error);
        const double ratio = (without[i].misfit - 1) / left;
        cause.probability = unexplained && ratio < kConvincing ? kDoubtful : std::min(kCertain, 1 - 0.5 / (1 + ratio));
        for (const auto& rival : selection.rivals[i]) {
            MountModel model = selection.models_without[i];
            rival.candidate.apply(model, rival.values);
            cause.rivals.push_back({rival.candidate.cause, rival.candidate.where,
                                    makeParameters(rival.candidate, model, {}),
                                    updating::findSeparatingRun(candidate.cause, rival.candidate.cause)});
        }
        if (!cause.rivals.empty()) cause.probability = std::min(cause.probability, 0.6);
        const auto known =
            std::find_if(causes.begin(), causes.end(), [&](const Cause& c) { return c.cause == cause.cause; });
        if (known == causes.end()) {
            causes.push_back(cause);
            continue;
        }
        known->where.insert(known->where.end(), cause.where.begin(), cause.where.end());
        known->parameters.insert(known->parameters.end(), cause.parameters.begin(), cause.parameters.end());
        known->rivals.insert(known->rivals.end(), cause.rivals.begin(), cause.rivals.end());
        known->gain_db = std::max(known->gain_db, cause.gain_db);
        known->probability = std::max(known->probability, cause.probability);
    }
    for (auto& cause : causes) {
        std::sort(cause.where.begin(), cause.where.end());
        cause.where.erase(std::unique(cause.where.begin(), cause.where.end()), cause.where.end());
    }
    std::stable_sort(causes.begin(), causes.end(),
                     [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
    return causes;
}

}  // namespace wems::identify
