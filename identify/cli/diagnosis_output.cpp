#include "identify/cli/diagnosis_output.hpp"

#include <algorithm>
#include <cmath>

#include "identify/cli/command.hpp"
#include "models/format_number.hpp"

namespace wems::identify::cli {
namespace {

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
                          {"where", cause.where},
                          {"parameters", makeParameters(cause.parameters, true)},
                          {"rivals", rivals}});
    }
    const auto &before = diagnosis.error_before, &after = diagnosis.error_after;
    return {{"verdict", formatVerdict(diagnosis.verdict)},
            {"error_before", group(before)},
            {"error_after", group(after)},
            {"gain_db",
             group({gain(before.identification, after.identification), gain(before.validation, after.validation)})},
            {"causes", causes},
            {"unexplained",
             {{"fraction", numberOrNull(after.validation)},
              {"noise_floor", numberOrNull(diagnosis.noise_floor.validation)},
              {"where", diagnosis.unexplained_where}}},
            {"open_loop_misfit",
             {{"before", numberOrNull(diagnosis.misfit_before)}, {"after", numberOrNull(diagnosis.misfit_after)}}},
            {"validated", diagnosis.validated}};
}

std::string describePlace(const Round& round) {
    if (!(round.identification_before > 1) || !(round.place_share > 0))
        return "what the mount leaves does not exceed the noise";
    return "a force of any history along " + round.place + " alone could make " +
           formatPercent(std::min(round.place_share, 1.0)) + " of what the mount leaves above the noise";
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

std::vector<std::vector<std::string>> tabulateErrors(const Diagnosis& diagnosis) {
    const auto row = [&](const std::string& name, double GroupError::*group) {
        return std::vector<std::string>{name, formatPercent(diagnosis.error_before.*group),
                                        formatPercent(diagnosis.error_after.*group),
                                        formatPercent(diagnosis.noise_floor.*group)};
    };
    return {row("identification", &GroupError::identification), row("validation", &GroupError::validation)};
}

std::string formatDiagnosis(const Diagnosis& diagnosis, TextStyle style) {
    std::string text;
    for (const auto& note : diagnosis.notes) text += "Motion: " + note + "\n";
    if (!diagnosis.validated)
        text +=
            "No validation recordings: the identification recordings judge themselves, which flatters every cause.\n";
    text += "\nEquations of motion along the measured motion: misfit " + formatNumber(diagnosis.misfit_before, 4) +
            " before, " + formatNumber(diagnosis.misfit_after, 4) + " after (1 = noise alone)\n";
    for (std::size_t r = 0; r < diagnosis.rounds.size(); ++r) {
        const auto& round = diagnosis.rounds[r];
        text += "\nRound " + std::to_string(r + 1) + ": " + round.reason + "; " + describePlace(round) + "\n";
        Table table({"candidate", "identification", "validation", ""});
        for (std::size_t i = 0; i < round.trials.size(); ++i) {
            const auto& trial = round.trials[i];
            table.addRow({trial.candidate.describe(), formatNumber(trial.identification, 4),
                          formatNumber(trial.validation, 4), static_cast<int>(i) == round.taken ? "taken" : ""});
        }
        if (!table.empty()) text += table.format(style);
    }
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
    Table errors({"free simulation", "before", "after", "noise alone"});
    for (const auto& row : tabulateErrors(diagnosis)) errors.addRow(row);
    text += "\n" + errors.format(style);
    const bool unexplained = diagnosis.verdict == Diagnosis::Verdict::unexplained;
    text +=
        "\nVerdict: " + paint(formatVerdict(diagnosis.verdict), unexplained ? Colour::yellow : Colour::green, style) +
        "\n";
    if (!diagnosis.unexplained_where.empty())
        text += "What is left sits at: " + joinWords(diagnosis.unexplained_where, " ") + "\n";
    return text;
}

}  // namespace wems::identify::cli
