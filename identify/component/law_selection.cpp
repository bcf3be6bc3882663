#include "identify/component/law_selection.hpp"

#include <algorithm>
#include <cmath>

#include "models/sampled_motion.hpp"

namespace wems::identify {
namespace {

// Samples of the fastest stroke that a law needs: a corner of its force lies within a fortieth of the stroke then.
constexpr double kSamplesOfStroke = 40;
// A test that is not longer is taken whole: hundreds of laws along it take a second or two.
constexpr Eigen::Index kWhole = 10000;

/// Every n-th sample of a test that has far more than its strokes need.
ComponentData thin(const ComponentData& test) {
    if (test.count() <= kWhole) return test;
    const std::vector<Reversal> reversals = findReversals(test.q, 0.05);
    Eigen::Index shortest = test.count();
    for (std::size_t i = 1; i < reversals.size(); ++i)
        shortest = std::min(shortest, reversals[i].index - reversals[i - 1].index);
    const auto step =
        std::min(static_cast<Eigen::Index>(static_cast<double>(shortest) / kSamplesOfStroke), test.count() / kWhole);
    if (step < 2) return test;
    ComponentData thinned = test;
    const Eigen::Index count = 1 + (test.count() - 1) / step;
    const auto pick = [&](const Eigen::VectorXd& all, Eigen::VectorXd& some) {
        some.resize(count);
        for (Eigen::Index k = 0; k < count; ++k) some[k] = all[k * step];
    };
    pick(test.time, thinned.time);
    pick(test.q, thinned.q);
    pick(test.velocity, thinned.velocity);
    pick(test.force, thinned.force);
    return thinned;
}

}  // namespace

LawSelection selectLaw(const std::vector<ComponentData>& all, const std::vector<Stop>& stops) {
    std::vector<ComponentData> tests;
    for (const ComponentData& test : all) tests.push_back(thin(test));
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
