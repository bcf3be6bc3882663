#include "identify/commands/component_fit.hpp"

#include <limits>

#include "identify/fit/law_verdict.hpp"

namespace wems::identify::commands {
namespace {

/// The noise of a force cell is not known: what is left counts whole.
LawVerdict judge(const ComponentFit& fit) {
    return judgeLaw(fit.residual_fraction, std::numeric_limits<double>::infinity());
}

}  // namespace

nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters) {
    auto result = nlohmann::json::array();
    for (const auto& p : parameters)
        result.push_back({{"name", p.name},
                          {"value", numberOrNull(p.value)},
                          {"unit", p.unit},
                          {"interval95", {numberOrNull(p.lower), numberOrNull(p.upper)}}});
    return result;
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
    return {{"parameters", formatParameters(fit.parameters)},
            {"not_identifiable", unknown},
            {"residual", {{"fraction", fit.residual_fraction}, {"rms", fit.residual_rms}, {"unit", "N"}}},
            {"verdict", formatLawVerdict(judge(fit))},
            {"effective_samples", fit.effective_samples},
            {"notes", fit.notes}};
}

std::string formatText(const ComponentFit& fit, TextStyle style) {
    std::string text = tabulateParameters(fit.parameters).format(style);
    for (const auto& u : fit.not_identifiable)
        text += "not identifiable: " + u.name + "; " + u.separate_by + " would tell\n";
    text += "residual: " + formatNumber(100 * fit.residual_fraction, 3) + " % of the force, " +
            formatNumber(fit.residual_rms, 3) + " N RMS; " + formatNumber(fit.effective_samples, 3) +
            " independent samples\n" + describeLawVerdict(judge(fit)) + "\n";
    for (const auto& note : fit.notes) text += "note: " + note + "\n";
    return text;
}

}  // namespace wems::identify::commands
