#include "identify/component/law_selection.hpp"

#include <algorithm>
#include <cmath>

namespace wems::identify {

LawSelection selectLaw(const std::vector<ComponentData>& tests, const std::vector<Stop>& stops) {
    using Memory = LawTerms::Memory;
    const std::string place =
        tests.empty() ? std::string() : tests.front().connection + "." + "xyz"[tests.front().axis] + ".";
    std::vector<LawTerms> families{{}, {Memory::none, true, false}};
    for (const Memory memory : {Memory::hysteresis, Memory::gap_slider, Memory::sliders, Memory::gap_sliders})
        families.push_back({memory, false, false});
    families.push_back({Memory::sliders, true, false});
    const bool timed = std::all_of(tests.begin(), tests.end(), [](const auto& test) { return test.has_velocity; });
    if (timed) {
        families.push_back({Memory::none, false, true});
        families.push_back({Memory::none, true, true});
        families.push_back({Memory::sliders, false, true});
    }
    LawSelection selection;
    for (const LawTerms& terms : families) selection.tried.push_back(fitLaw(tests, terms, stops, place));
    std::stable_sort(selection.tried.begin(), selection.tried.end(),
                     [](const LawFit& a, const LawFit& b) { return a.parameter_count < b.parameter_count; });
    const auto closest = std::min_element(selection.tried.begin(), selection.tried.end(),
                                          [](const LawFit& a, const LawFit& b) { return a.fraction < b.fraction; });
    const double samples = std::max(2.0, closest->effective_samples);
    for (const LawFit& fit : selection.tried)
        selection.information.push_back(2 * samples * std::log(std::max(fit.fraction, 1e-9)) +
                                        fit.parameter_count * std::log(samples));
    const double best = *std::min_element(selection.information.begin(), selection.information.end());
    while (selection.information[selection.chosen] > best + 6) ++selection.chosen;
    return selection;
}

SurfaceKind nameByMemory(SurfaceKind kind, const LawSelection& laws) {
    constexpr double half = 0.5, unexplained = 0.3;  // of what others leave; of the force (identify/fit/law_verdict)
    const LawFit& law = laws.law();
    double state = 1;
    for (const SurfaceCandidate& candidate : kind.candidates) state = std::min(state, candidate.fraction);
    if (std::min(state, law.fraction) > unexplained) {
        kind.name = "unexplained";
        kind.statement = "No law that was tried describes this force: what is listed below leaves most of it.";
        return kind;
    }
    const bool named = kind.name.rfind("friction", 0) == 0 || kind.name == "hysteresis";
    if (law.fraction > half * state) return kind;
    if (law.terms.memory != LawTerms::Memory::none && !named) {
        const bool gap = law.terms.memory == LawTerms::Memory::gap_slider && !law.law.sliders.empty() &&
                         law.law.sliders.front().gap > law.law.sliders.front().yield_displacement;
        kind.name = gap ? "friction with gap at reversals" : "hysteresis";
        kind.statement = "The force depends on the path: sliders along the recorded motion describe it.";
        kind.parameters = law.parameters;
    } else if (law.terms.relaxation && !named) {
        kind.name = "viscoelastic";
        kind.statement = "The force relaxes: Maxwell branches along the recorded motion describe it.";
        kind.parameters = law.parameters;
    }
    return kind;
}

}  // namespace wems::identify
