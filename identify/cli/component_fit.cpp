#include "identify/cli/component_fit.hpp"

#include <cmath>
#include <iostream>
#include <limits>

#include "identify/fit/law_verdict.hpp"

namespace wems::identify::cli {
namespace {

nlohmann::json finiteOrNull(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace

nlohmann::json formatParameters(const std::vector<ComponentParameter>& parameters) {
    auto result = nlohmann::json::array();
    for (const auto& p : parameters)
        result.push_back({{"name", p.name},
                          {"value", finiteOrNull(p.value)},
                          {"unit", p.unit},
                          {"interval95", {finiteOrNull(p.lower), finiteOrNull(p.upper)}}});
    return result;
}

Table tabulateParameters(const std::vector<ComponentParameter>& parameters) {
    Table table({"parameter", "value", "95 % from", "to", "unit"});
    for (const auto& p : parameters)
        table.addRow({p.name, formatNumber(p.value), formatNumber(p.lower), formatNumber(p.upper), p.unit});
    return table;
}

void reportComponentFit(const ComponentFit& fit, const CommonOptions& options, OutputFiles& outputs) {
    // The noise of a force cell is not known: what is left counts whole.
    const LawVerdict verdict = judgeLaw(fit.residual_fraction, std::numeric_limits<double>::infinity());
    nlohmann::json unknown = nlohmann::json::array();
    for (const auto& u : fit.not_identifiable)
        unknown.push_back({{"names", {u.name}}, {"known_combination", ""}, {"separate_by", u.separate_by}});
    const nlohmann::json result = {
        {"parameters", formatParameters(fit.parameters)},
        {"not_identifiable", unknown},
        {"residual", {{"fraction", fit.residual_fraction}, {"rms", fit.residual_rms}, {"unit", "N"}}},
        {"verdict", formatLawVerdict(verdict)},
        {"effective_samples", fit.effective_samples},
        {"notes", fit.notes}};
    if (options.printsText()) {
        std::cout << tabulateParameters(fit.parameters).format(outputStyle());
        for (const auto& u : fit.not_identifiable)
            std::cout << "not identifiable: " << u.name << "; " << u.separate_by << " would tell\n";
        std::cout << "residual: " << formatNumber(100 * fit.residual_fraction, 3) << " % of the force, "
                  << formatNumber(fit.residual_rms, 3) << " N RMS; " << formatNumber(fit.effective_samples, 3)
                  << " independent samples\n"
                  << describeLawVerdict(verdict) << "\n";
        for (const auto& note : fit.notes) std::cout << "note: " << note << "\n";
    }
    writeJson(result, options, outputs);
}

}  // namespace wems::identify::cli
