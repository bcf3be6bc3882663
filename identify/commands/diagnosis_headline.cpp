#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/commands/diagnosis_output.hpp"
#include "identify/commands/format.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify::commands {
namespace {

struct EngineeringUnit {
    double factor;
    std::string name;  ///< with a blank before it, empty for a pure number
};

EngineeringUnit findEngineeringUnit(const std::string& unit) {
    if (unit == "m") return {1e3, " mm"};
    if (unit == "s") return {1e3, " ms"};
    if (unit == "N/m") return {1e-3, " N/mm"};
    return {1, unit == "-" ? std::string() : " " + unit};
}

/// As many digits as its uncertainty leaves, two of that.
std::string formatWithRadius(double value, double radius, const EngineeringUnit& unit) {
    constexpr int without = 4, most = 7;
    value *= unit.factor;
    radius *= unit.factor;
    if (!(std::isfinite(radius) && radius > 0)) return formatNumber(value, without) + unit.name;
    const double ratio = std::max(1.0, std::abs(value) / radius);
    const int digits = std::min(most, 2 + static_cast<int>(std::floor(std::log10(ratio))));
    return formatNumber(value, digits) + " ± " + formatNumber(radius, 2) + unit.name;
}

std::optional<double> findBelieved(const MountModel& model, const std::string& name) {
    for (const char* of : {"", "body.", "load."}) {
        try {
            return getParameter(model, of + name);
        } catch (const InputError&) {  // under another name, or none of the model
        }
    }
    return std::nullopt;
}

std::string describeOffset(const Cause& cause, const MountModel& believed) {
    const CauseParameter* farthest = nullptr;
    double shift = 0;
    for (const CauseParameter& parameter : cause.parameters) {
        const double from = findBelieved(believed, "center_of_gravity." + parameter.name).value_or(0);
        if (farthest != nullptr && std::abs(parameter.value - from) <= std::abs(shift)) continue;
        farthest = &parameter;
        shift = parameter.value - from;
    }
    if (farthest == nullptr) return "The centre of gravity lies elsewhere";
    const std::string way = farthest->name == "z" ? (shift > 0 ? "above" : "below")
                                                  : (shift > 0 ? "towards +" : "towards -") + farthest->name + " from";
    return "The centre of gravity lies " +
           formatWithRadius(std::abs(shift), 0.5 * (farthest->upper - farthest->lower), findEngineeringUnit("m")) +
           " " + way + " where the model has it";
}

/// The parameter that is farthest from the model, relative to it; the first where the model has none of them.
std::string describeLargest(const Cause& cause, const MountModel& believed) {
    if (cause.parameters.empty()) return "The cause is " + cause.cause;
    const CauseParameter* largest = &cause.parameters.front();
    std::optional<double> had;
    double most = -1;
    for (const CauseParameter& parameter : cause.parameters) {
        const auto from = findBelieved(believed, parameter.name);
        const double change =
            from && *from != 0 && std::isfinite(parameter.value) ? std::abs(parameter.value / *from - 1) : 0;
        if (change <= most) continue;
        most = change;
        largest = &parameter;
        had = from;
    }
    const EngineeringUnit unit = findEngineeringUnit(largest->unit);
    std::string text = cause.cause + ": " + largest->name;
    if (!std::isfinite(largest->value)) return text + " does not exist, though the model has it";
    text += " is " + formatWithRadius(largest->value, 0.5 * (largest->upper - largest->lower), unit);
    if (had) text += " where the model has " + formatNumber(unit.factor * *had, 4) + unit.name;
    if (cause.parameters.size() > 1) text += ", with " + std::to_string(cause.parameters.size() - 1) + " more";
    return text;
}

}  // namespace

std::string makeHeadline(const Diagnosis& diagnosis, const MountModel& believed) {
    const auto group = diagnosis.validated ? &GroupError::validation : &GroupError::identification;
    const std::string error = formatPercent(diagnosis.error_before.*group);
    const auto cause = std::max_element(diagnosis.causes.begin(), diagnosis.causes.end(),
                                        [](const Cause& a, const Cause& b) { return a.gain_db < b.gain_db; });
    if (cause == diagnosis.causes.end())
        return diagnosis.verdict == Diagnosis::Verdict::unexplained
                   ? "The simulation errs by " + error + ", and no cause of the catalogue explains it."
                   : "Nothing is missing: the simulation errs by " + error + ", as noise and tolerances allow.";
    std::string text =
        cause->cause == "cog_offset" ? describeOffset(*cause, believed) : describeLargest(*cause, believed);
    if (const long share = std::lround(100 * cause->share); share > 0)
        text += "; this explains " + std::to_string(share) + " % of the error";
    if (diagnosis.verdict == Diagnosis::Verdict::unexplained) text += ". Something else is missing too";
    return text + ".";
}

}  // namespace wems::identify::commands
