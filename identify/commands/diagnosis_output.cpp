#include "identify/commands/diagnosis_output.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/commands/format.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify::commands {

namespace {

nlohmann::json numberOrNull(const std::optional<double>& value) {
    return value ? commands::numberOrNull(*value) : nlohmann::json(nullptr);
}

nlohmann::json group(const GroupError& error) {
    return {{"identification", numberOrNull(error.identification)}, {"validation", numberOrNull(error.validation)}};
}

double gain(double before, double after) {
    return after > 0 ? 20 * std::log10(before / after) : 0;
}

nlohmann::json makeParameters(const std::vector<CauseParameter>& parameters, bool with_interval) {
    auto list = nlohmann::json::array();
    for (const auto& p : parameters) {
        nlohmann::json entry{{"name", p.name}, {"value", numberOrNull(p.value)}, {"unit", p.unit}};
        if (with_interval) entry["interval95"] = {numberOrNull(p.lower), numberOrNull(p.upper)};
        list.push_back(entry);
    }
    return list;
}

nlohmann::json makeElasticLaws(const std::vector<ElasticLaw>& laws) {
    auto list = nlohmann::json::array();
    for (const auto& law : laws) {
        std::vector<double> half_width;
        for (const double deviation : law.deviation) half_width.push_back(kTwoSided95 * deviation);
        list.push_back({{"where", law.where},
                        {"displacement", law.displacement},
                        {"believed", law.believed},
                        {"force", law.force},
                        {"half_width95", half_width}});
    }
    return list;
}

std::vector<std::vector<std::string>> tabulateElasticLaw(const ElasticLaw& law) {
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < law.displacement.size(); ++i)
        rows.push_back({formatNumber(1e3 * law.displacement[i], 4), formatNumber(law.believed[i], 4),
                        formatNumber(law.force[i], 4), formatNumber(kTwoSided95 * law.deviation[i], 2)});
    return rows;
}

nlohmann::json makeFitted(const std::vector<FittedSet>& sets) {
    auto list = nlohmann::json::array();
    for (const auto& own : sets)
        list.push_back({{"causes", own.causes},
                        {"log_evidence", numberOrNull(own.log_evidence)},
                        {"error", own.error ? numberOrNull(*own.error) : nullptr},
                        {"outcome", own.outcome}});
    return list;
}

/// What was tried in which order.
nlohmann::json makeDecisions(const std::vector<Decision>& decisions) {
    auto list = nlohmann::json::array();
    for (const auto& decision : decisions) {
        auto candidates = nlohmann::json::array();
        for (const auto& candidate : decision.candidates)
            candidates.push_back({{"cause", candidate.cause},
                                  {"where", candidate.where},
                                  {"log_odds", numberOrNull(candidate.log_odds)}});
        list.push_back({{"action", decision.action},
                        {"causes", decision.causes},
                        {"log_evidence", numberOrNull(decision.log_evidence)},
                        {"misfit", decision.misfit},
                        {"error", numberOrNull(decision.error)},
                        {"candidates", candidates},
                        {"fitted", makeFitted(decision.fitted)}});
    }
    return list;
}

}  // namespace

nlohmann::json makeDiagnosisJson(const Diagnosis& diagnosis) {
    auto causes = nlohmann::json::array();
    for (const auto& cause : diagnosis.causes) {
        auto rivals = nlohmann::json::array();
        for (const auto& rival : cause.rivals)
            rivals.push_back({{"cause", rival.cause},
                              {"where", rival.where},
                              {"parameters", makeParameters(rival.parameters, false)},
                              {"separate_by", rival.separate_by}});
        causes.push_back({{"cause", cause.cause},
                          {"probability", numberOrNull(cause.probability)},
                          {"gain_db", numberOrNull(cause.gain_db)},
                          {"share", numberOrNull(cause.share)},
                          {"where", cause.where},
                          {"parameters", makeParameters(cause.parameters, true)},
                          {"rivals", rivals}});
    }
    auto adjustments = nlohmann::json::array();
    for (const auto& adjustment : diagnosis.adjustments) {
        const CauseParameter& p = adjustment.parameter;
        adjustments.push_back({{"name", p.name},
                               {"believed", numberOrNull(adjustment.believed)},
                               {"tolerance", numberOrNull(adjustment.tolerance)},
                               {"value", numberOrNull(p.value)},
                               {"interval95", {numberOrNull(p.lower), numberOrNull(p.upper)}},
                               {"unit", p.unit}});
    }
    const auto &before = diagnosis.error_before, &after = diagnosis.error_after;
    return {{"verdict", formatVerdict(diagnosis.verdict)},
            {"error_before", group(before)},
            {"error_adjusted", group(diagnosis.error_adjusted)},
            {"error_after", group(after)},
            {"gain_db",
             group({gain(before.identification, after.identification), gain(before.validation, after.validation)})},
            {"causes", causes},
            {"adjustments", adjustments},
            {"prediction",
             {{"band", numberOrNull(diagnosis.prediction_band)},
              {"identification_band", numberOrNull(diagnosis.identification_band)}}},
            {"decisions", makeDecisions(diagnosis.decisions)},
            {"unexplained",
             {{"fraction", numberOrNull(after.validation)},
              {"noise_floor", numberOrNull(diagnosis.noise_floor.validation)},
              {"where", diagnosis.unexplained_where},
              {"elastic_laws", makeElasticLaws(diagnosis.elastic_laws)}}},
            {"open_loop_misfit",
             {{"before", numberOrNull(diagnosis.misfit_before)}, {"after", numberOrNull(diagnosis.misfit_after)}}},
            {"validated", diagnosis.validated}};
}

std::vector<std::vector<std::string>> tabulateCandidates(const Decision& decision) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& candidate : decision.candidates)
        rows.push_back({candidate.cause, joinWords(candidate.where, " "), formatNumber(candidate.log_odds, 4)});
    return rows;
}

std::vector<std::vector<std::string>> tabulateFitted(const Decision& decision) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& own : decision.fitted)
        rows.push_back({own.causes.empty() ? "no cause" : joinWords(own.causes, ", "),
                        formatNumber(own.log_evidence, 4), own.error ? formatNumber(100 * *own.error, 3) : "",
                        own.outcome});
    return rows;
}

std::string describeDecision(const Decision& decision) {
    return (decision.causes.empty() ? "no cause" : joinWords(decision.causes, ", ")) + " (" + decision.action +
           (decision.misfit.empty() ? std::string(")")
                                    : "); misfit of the mount's equation " + formatNumber(decision.misfit.front(), 4));
}

std::vector<std::vector<std::string>> tabulateAdjustments(const Diagnosis& diagnosis) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& adjustment : diagnosis.adjustments) {
        const CauseParameter& p = adjustment.parameter;
        rows.push_back({p.name, formatNumber(adjustment.believed), formatNumber(adjustment.tolerance, 3),
                        formatNumber(p.value), formatNumber(p.lower) + " … " + formatNumber(p.upper), p.unit});
    }
    return rows;
}

std::vector<std::vector<std::string>> tabulateCauses(const Diagnosis& diagnosis) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& cause : diagnosis.causes) {
        bool first = true;
        for (const auto& p : cause.parameters) {
            const bool removed = !std::isfinite(p.value);
            rows.push_back({first ? cause.cause : "", first ? formatNumber(cause.probability, 3) : "",
                            first ? formatNumber(cause.gain_db, 3) : "", p.name,
                            removed ? "no stop" : formatNumber(p.value),
                            removed ? "" : formatNumber(p.lower) + " … " + formatNumber(p.upper), p.unit});
            first = false;
        }
    }
    return rows;
}

bool usesTolerances(const Diagnosis& diagnosis) {
    return diagnosis.of_element || diagnosis.error_adjusted.identification != diagnosis.error_before.identification;
}

std::string describeAllowed(const Diagnosis& diagnosis, const std::string& what) {
    std::string text = "Noise and what is not known of the numbers allow the validation " + what + " an error of " +
                       formatPercent(*diagnosis.prediction_band);
    if (diagnosis.identification_band)
        text += ", the identification " + what + " one of " + formatPercent(*diagnosis.identification_band);
    return text + " (95 %).";
}

std::vector<std::vector<std::string>> tabulateErrors(const Diagnosis& diagnosis) {
    const auto row = [&](const std::string& name, double GroupError::*group) {
        std::vector<std::string> cells{name, formatPercent(diagnosis.error_before.*group),
                                       formatPercent(diagnosis.error_after.*group),
                                       formatPercent(diagnosis.noise_floor.*group)};
        if (usesTolerances(diagnosis)) cells.insert(cells.begin() + 2, formatPercent(diagnosis.error_adjusted.*group));
        return cells;
    };
    return {row("identification", &GroupError::identification), row("validation", &GroupError::validation)};
}

std::string formatDiagnosis(const Diagnosis& diagnosis, TextStyle style) {
    std::string text;
    for (const auto& note : diagnosis.notes) text += "Motion: " + note + "\n";
    if (!diagnosis.validated)
        text +=
            "No validation recordings: the identification recordings judge themselves, which flatters every cause.\n";
    text += std::string("\n") + (diagnosis.of_element ? "Force" : "Equations of motion") +
            " along the measured motion: misfit " + formatNumber(diagnosis.misfit_before, 4) + " before, " +
            formatNumber(diagnosis.misfit_after, 4) + " after (1 = noise alone)\n";
    for (std::size_t r = 0; r < diagnosis.decisions.size(); ++r) {
        text += "\nRound " + std::to_string(r + 1) + ": " + describeDecision(diagnosis.decisions[r]) + "\n";
        Table table({"candidate", "where", "log odds"});
        for (const auto& row : tabulateCandidates(diagnosis.decisions[r])) table.addRow(row);
        if (!table.empty()) text += table.format(style);
        Table fitted(kFittedColumns);
        for (const auto& row : tabulateFitted(diagnosis.decisions[r])) fitted.addRow(row);
        if (!fitted.empty()) text += "\n" + fitted.format(style);
    }
    Table adjusted({"adjusted within its tolerance", "believed", "±", "value", "95 % interval", "unit"});
    for (const auto& row : tabulateAdjustments(diagnosis)) adjusted.addRow(row);
    if (!adjusted.empty()) text += "\n" + adjusted.format(style);
    Table parameters({"cause", "probability", "gain dB", "parameter", "value", "95 % interval", "unit"});
    for (const auto& row : tabulateCauses(diagnosis)) parameters.addRow(row);
    if (!parameters.empty()) text += "\n" + parameters.format(style);
    for (const auto& cause : diagnosis.causes)
        for (const auto& rival : cause.rivals) {
            text += "Tie: " + cause.cause + " cannot be told from " + rival.cause + " at " +
                    joinWords(rival.where, " ") + " (";
            for (const auto& p : rival.parameters) text += " " + p.name + " = " + formatNumber(p.value);
            text += " ); to separate: " + rival.separate_by + "\n";
        }
    std::vector<std::string> columns{diagnosis.of_element ? "force" : "free simulation", "before", "after",
                                     "noise alone"};
    if (usesTolerances(diagnosis)) columns.insert(columns.begin() + 2, "adjusted");
    Table errors(columns);
    for (const auto& row : tabulateErrors(diagnosis)) errors.addRow(row);
    text += "\n" + errors.format(style);
    if (diagnosis.prediction_band) text += describeAllowed(diagnosis, "runs") + "\n";
    const bool unexplained = diagnosis.verdict == Diagnosis::Verdict::unexplained;
    text +=
        "\nVerdict: " + paint(formatVerdict(diagnosis.verdict), unexplained ? Colour::yellow : Colour::green, style) +
        "\n";
    if (!diagnosis.unexplained_where.empty())
        text += "What is left sits at: " + joinWords(diagnosis.unexplained_where, " ") + "\n";
    for (const ElasticLaw& law : diagnosis.elastic_laws) {
        text += "\nElastic force of " + law.where + ", which no cause describes:\n";
        Table forces({"displacement mm", "believed N", "recordings N", "± N (95 %)"});
        for (const auto& row : tabulateElasticLaw(law)) forces.addRow(row);
        text += forces.format(style);
    }
    return text;
}

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

/// Where the force over the displacement is one that no cause describes; empty if it is nowhere.
std::string describeOtherForms(const Diagnosis& diagnosis) {
    std::vector<std::string> places;
    for (const ElasticLaw& law : diagnosis.elastic_laws) places.push_back(law.where);
    if (places.empty()) return {};
    return ": the elastic force of " + joinWords(places, ", ") + " has another form than any cause gives it";
}

}  // namespace

std::string makeHeadline(const Diagnosis& diagnosis, const MountModel& believed) {
    const auto group = diagnosis.validated ? &GroupError::validation : &GroupError::identification;
    const std::string error = formatPercent(diagnosis.error_before.*group);
    const auto cause = std::max_element(diagnosis.causes.begin(), diagnosis.causes.end(),
                                        [](const Cause& a, const Cause& b) { return a.gain_db < b.gain_db; });
    if (cause == diagnosis.causes.end())
        return diagnosis.verdict == Diagnosis::Verdict::unexplained
                   ? "The simulation errs by " + error + ", and no cause of the catalogue explains it" +
                         describeOtherForms(diagnosis) + "."
                   : "Nothing is missing: the simulation errs by " + error + ", as noise and tolerances allow.";
    std::string text =
        cause->cause == "cog_offset" ? describeOffset(*cause, believed) : describeLargest(*cause, believed);
    if (const long share = std::lround(100 * cause->share); share > 0)
        text += "; this explains " + std::to_string(share) + " % of the error";
    if (diagnosis.verdict == Diagnosis::Verdict::unexplained)
        text += ". Something else is missing too" + describeOtherForms(diagnosis);
    return text + ".";
}

}  // namespace wems::identify::commands
