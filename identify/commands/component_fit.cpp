#include "identify/commands/component_fit.hpp"

#include <cmath>
#include <limits>

#include "identify/commands/format.hpp"
#include "identify/fit/law_verdict.hpp"

namespace wems::identify::commands {

namespace {

/// The noise of a force cell is not known: what is left counts whole.
LawVerdict judge(const ComponentFit& fit) {
    return judgeLaw(fit.residual_fraction, std::numeric_limits<double>::infinity());
}

}  // namespace

nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters, const GainTolerances& gains) {
    auto result = nlohmann::json::array();
    for (const auto& p : parameters) {
        const auto wide = calcIntervalWithGains(p, gains);
        result.push_back({{"name", p.name},
                          {"value", numberOrNull(p.value)},
                          {"unit", p.unit},
                          {"interval95", {numberOrNull(p.lower), numberOrNull(p.upper)}},
                          {"interval95_with_gains", {numberOrNull(wide[0]), numberOrNull(wide[1])}}});
    }
    return result;
}

std::string describeGains(const std::vector<ComponentParameter>& parameters, const GainTolerances& gains) {
    std::string text;
    for (const auto& p : parameters) {
        const auto wide = calcIntervalWithGains(p, gains);
        constexpr double notable = 1.1;  // times as wide: less is not worth a reader's time
        if (!std::isfinite(wide[0]) || wide[1] - wide[0] < notable * (p.upper - p.lower)) continue;
        text += (text.empty() ? "" : "; ") + p.name + " " + formatNumber(wide[0]) + " to " + formatNumber(wide[1]) +
                " " + p.unit;
    }
    if (text.empty()) return text;
    return "with gains within " + formatPercent(gains.force) + " of the force and " +
           formatPercent(gains.displacement) + " of the displacement: " + text + "\n";
}

Table tabulateParameters(const std::vector<ComponentParameter>& parameters) {
    Table table({"parameter", "value", "95 % from", "to", "unit"});
    for (const auto& p : parameters)
        table.addRow({p.name, formatNumber(p.value), formatNumber(p.lower), formatNumber(p.upper), p.unit});
    return table;
}

nlohmann::json toJson(const ComponentFit& fit) {
    nlohmann::json unknown = nlohmann::json::array();
    for (const auto& u : fit.not_identifiable)
        unknown.push_back({{"names", {u.name}}, {"known_combination", ""}, {"separate_by", u.separate_by}});
    return {{"parameters", formatParameters(fit.parameters, fit.gains)},
            {"not_identifiable", unknown},
            {"residual", {{"fraction", fit.residual_fraction}, {"rms", fit.residual_rms}, {"unit", "N"}}},
            {"verdict", formatLawVerdict(judge(fit))},
            {"effective_samples", fit.effective_samples},
            {"notes", fit.notes}};
}

std::string formatText(const ComponentFit& fit, TextStyle style) {
    std::string text = tabulateParameters(fit.parameters).format(style) + describeGains(fit.parameters, fit.gains);
    for (const auto& u : fit.not_identifiable)
        text += "not identifiable: " + u.name + "; " + u.separate_by + " would tell\n";
    text += "residual: " + formatNumber(100 * fit.residual_fraction, 3) + " % of the force, " +
            formatNumber(fit.residual_rms, 3) + " N RMS; " + formatNumber(fit.effective_samples, 3) +
            " independent samples\n" + describeLawVerdict(judge(fit)) + "\n";
    for (const auto& note : fit.notes) text += "note: " + note + "\n";
    return text;
}

nlohmann::json toJson(const LawSelection& selection, const std::vector<ComponentData>& others,
                      const GainTolerances& gains) {
    auto tried = nlohmann::json::array(), validation = nlohmann::json::array();
    for (std::size_t i = 0; i < selection.tried.size(); ++i) {
        const LawFit& fit = selection.tried[i];
        tried.push_back({{"law", fit.terms.name()},
                         {"root_relative_squared_error", numberOrNull(fit.fraction)},
                         {"criterion", numberOrNull(selection.information[i])},
                         {"parameters", fit.parameter_count}});
    }
    const LawFit& law = selection.law();
    for (const ComponentData& other : others)
        validation.push_back(
            {{"file", other.file},
             {"root_relative_squared_error", numberOrNull(calcLawError(law.law, law.force_offset, other))}});
    return {{"law", law.terms.name()},
            {"parameters", formatParameters(law.parameters, gains)},
            {"root_relative_squared_error", numberOrNull(law.fraction)},
            {"tried", tried},
            {"validation", validation}};
}

std::string formatText(const LawSelection& selection, const std::vector<ComponentData>& others, TextStyle style) {
    const LawFit& law = selection.law();
    Table laws({"law along the motion", "error", "numbers"});
    for (const LawFit& fit : selection.tried)
        laws.addRow({fit.terms.name(), formatPercent(fit.fraction), std::to_string(fit.parameter_count)});
    std::string text = "\nlaws along the recorded motion, with their memory:\n" + laws.format(style) +
                       "chosen: " + law.terms.name() + "\n" + tabulateParameters(law.parameters).format(style);
    for (const ComponentData& other : others)
        text += "on " + other.file + ": " + formatPercent(calcLawError(law.law, law.force_offset, other)) + "\n";
    return text;
}

}  // namespace wems::identify::commands
