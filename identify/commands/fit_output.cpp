#include "identify/commands/fit_output.hpp"

#include "identify/commands/format.hpp"
#include "identify/fit/law_verdict.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"

namespace wems::identify::commands {

nlohmann::json makeFitJson(const FitResult& fit, const std::vector<std::string>& notes, const Timing& timing) {
    auto parameters = nlohmann::json::array(), unknown = nlohmann::json::array();
    for (const auto& p : fit.parameters)
        parameters.push_back({{"name", p.name},
                              {"value", p.value},
                              {"unit", p.unit},
                              {"interval95", p.interval95},
                              {"standard_error", p.standard_error},
                              {"model_value", p.model_value}});
    for (const auto& group : fit.not_identifiable) {
        nlohmann::json entry = {{"names", group.names},
                                {"known_combination", group.combination},
                                {"unit", group.unit},
                                {"separate_by", group.separate_by}};
        if (!group.combination.empty()) {
            entry["value"] = group.value;
            entry["interval95"] = group.interval95;
        }
        if (!group.reason.empty()) entry["reason"] = group.reason;
        unknown.push_back(std::move(entry));
    }
    nlohmann::json result = {
        {"parameters", parameters},
        {"not_identifiable", unknown},
        {"residual", {{"fraction", fit.residual_fraction}, {"over_noise", fit.residual_over_noise}}},
        {"verdict", formatLawVerdict(judgeLaw(fit.residual_fraction, fit.residual_over_noise))},
        {"notes", notes}};
    for (const auto& [step, seconds] : timing) result["timing"][step] = seconds;
    return result;
}

Table makeParameterTable(const FitResult& fit) {
    Table table({"parameter", "model", "identified", "95 % from", "to", "unit"});
    for (const auto& p : fit.parameters)
        table.addRow({p.name, formatNumber(p.model_value), formatNumber(p.value, 6), formatNumber(p.interval95[0], 6),
                      formatNumber(p.interval95[1], 6), p.unit});
    return table;
}

Table makeOpenTable(const FitResult& fit) {
    Table table(
        {"not identifiable one by one", "what is known", "value", "95 % from", "to", "unit", "would be told by"});
    for (const auto& group : fit.not_identifiable) {
        const bool known = !group.combination.empty();
        table.addRow({joinWords(group.names),
                      known                  ? group.combination
                      : group.reason.empty() ? "nothing"
                                             : group.reason,
                      known ? formatNumber(group.value, 6) : "-", known ? formatNumber(group.interval95[0], 6) : "-",
                      known ? formatNumber(group.interval95[1], 6) : "-", known ? group.unit : "", group.separate_by});
    }
    return table;
}

std::string describeResidual(const FitResult& fit) {
    return "unexplained: " + formatNumber(100 * fit.residual_fraction, 3) +
           " % of the wrench that the motion demands; " +
           describeLawVerdict(judgeLaw(fit.residual_fraction, fit.residual_over_noise));
}

void addFittedModel(const MountModel& fitted, const std::string& file, OutputFiles& outputs) {
    try {
        writeMountModel(fitted, file, outputs);
    } catch (const InputError& error) {
        if (!error.location().file.empty()) throw;
        throw InputError({file, 0, error.location().key},
                         "the fitted value makes no model that could be read again: it " + error.problem(),
                         error.accepted());
    }
}

}  // namespace wems::identify::commands
