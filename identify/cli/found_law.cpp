#include "identify/cli/found_law.hpp"

#include <iostream>

#include "identify/cli/command.hpp"
#include "identify/cli/component_fit.hpp"

namespace wems::identify::cli {

nlohmann::json formatSelection(const LawSelection& selection, const std::vector<ComponentData>& others) {
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

void printSelection(const LawSelection& selection, const std::vector<ComponentData>& others) {
    const LawFit& law = selection.law();
    std::cout << "\nlaws along the recorded motion, with their memory:\n";
    Table laws({"law", "error", "numbers"});
    for (const LawFit& fit : selection.tried)
        laws.addRow({fit.terms.name(), formatPercent(fit.fraction), std::to_string(fit.parameter_count)});
    std::cout << laws.format(outputStyle()) << "chosen: " << law.terms.name() << "\n"
              << tabulateParameters(law.parameters).format(outputStyle());
    for (const ComponentData& other : others)
        std::cout << "on " << other.file << ": " << formatPercent(calcLawError(law.law, law.force_offset, other))
                  << "\n";
}

}  // namespace wems::identify::cli
