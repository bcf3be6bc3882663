#include "identify/commands/found_law.hpp"

#include "identify/commands/component_fit.hpp"
#include "identify/commands/format.hpp"

namespace wems::identify::commands {

nlohmann::json toJson(const LawSelection& selection, const std::vector<ComponentData>& others) {
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
            {"parameters", formatParameters(law.parameters)},
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
