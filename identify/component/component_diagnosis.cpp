#include "identify/component/component_diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "identify/component/component_fit.hpp"
#include "identify/component/element_problem.hpp"
#include "identify/residual/residual_diagnosis.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {

namespace {

// Samples of the fastest stroke that a law needs: a corner of its force lies within a fortieth of the stroke then.
constexpr double kSamplesOfStroke = 40;
// Of the whole travel: a motion that goes back by less has not turned (the surface's strokes use the same).
constexpr double kTurn = 0.05;
// A test that is not longer is taken whole: hundreds of laws along it take a second or two.
constexpr Eigen::Index kWhole = 10000;

/// Every n-th sample of a test that has far more than its strokes need.
ComponentData thin(const ComponentData& test) {
    if (test.count() <= kWhole) return test;
    const std::vector<Reversal> reversals = findReversals(test.q, kTurn);
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
    const std::string place =
        tests.empty() ? std::string() : tests.front().connection + "." + "xyz"[tests.front().axis] + ".";
    std::vector<LawTerms> families{
        {}, {LawTerms::Memory::none, true, false}, {LawTerms::Memory::none, false, false, true}};
    // A motion that goes one way shows of a slider a spring that yields, as a curve does.
    const bool turns =
        std::any_of(tests.begin(), tests.end(), [](const auto& test) { return !findReversals(test.q, kTurn).empty(); });
    if (turns) {
        for (const LawTerms::Memory memory : {LawTerms::Memory::hysteresis, LawTerms::Memory::gap_slider,
                                              LawTerms::Memory::sliders, LawTerms::Memory::gap_sliders})
            families.push_back({memory, false, false});
        families.push_back({LawTerms::Memory::sliders, true, false});
        families.push_back({LawTerms::Memory::sliders, false, false, true});
    }
    const bool timed = std::all_of(tests.begin(), tests.end(), [](const auto& test) { return test.has_velocity; });
    if (timed) {
        families.push_back({LawTerms::Memory::none, false, true});
        families.push_back({LawTerms::Memory::none, true, true});
        if (turns) families.push_back({LawTerms::Memory::sliders, false, true});
        families.push_back({LawTerms::Memory::none, false, true, true});
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
    } else if (law.terms.curve && !named) {
        kind.name = "force curve";
        kind.statement = "The force follows the displacement along a curve that is none of the laws tried first.";
        kind.parameters = law.parameters;
    }
    return kind;
}

namespace {

std::vector<ComponentData> extractAll(const std::vector<Recording>& recordings, const MountModel& model,
                                      ComponentOptions& options, std::vector<std::string>& notes) {
    std::vector<ComponentData> tests;
    for (const Recording& recording : recordings) {
        tests.push_back(extractComponent(recording, completeOptions(recording, model, options)));
        options.connection = tests.front().connection;
        options.axis = tests.front().axis;
        for (const std::string& note : tests.back().notes)
            if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
    }
    return tests;
}

class ElementDiagnostician {
public:
    ElementDiagnostician(const std::vector<ComponentData>& tests, const std::vector<ComponentData>& judges,
                         const MountModel& model, std::size_t connection, int axis, const DiagnosisOptions& options)
        : model_(model),
          connection_(connection),
          axis_(axis),
          validated_(!judges.empty()),
          problem_(tests, judges.empty() ? tests : judges, model, connection, axis),
          options_(options) {}

    Diagnosis run() {
        ResidualDiagnosis found = diagnoseResidual(problem_, options_);
        result_ = std::move(found.diagnosis);
        answer_ = std::move(found.answer);
        result_.validated = validated_;
        result_.of_element = true;
        law_ = problem_.lawAt(answer_.best.values);
        if (isLeft(result_)) tryDistributions();
        result_.extended = model_;
        result_.extended.connections[connection_].axis[axis_] = law_;
        noteDelay();
        result_.verdict = judgeVerdict(result_);
        if (result_.verdict == Diagnosis::Verdict::unexplained)
            result_.unexplained_where = {problem_.place(), findRegime()};
        return std::move(result_);
    }

private:
    const Hypothesis& at(int h) const { return problem_.hypotheses()[h]; }

    GroupError errorOf(const AxisLaw& law, double delay) const {
        return {calcElementError(law, delay, problem_.tests()), calcElementError(law, delay, problem_.judges())};
    }

    /// Laws with distributions of sliders and branches: taken where they leave less than half of what the causes of
    /// the catalogue leave, to the tests and to those that judge.
    void tryDistributions() {
        if (options_.progress) options_.progress({"distributions of sliders and branches"});
        const LawSelection selection = selectLaw(problem_.tests(), law_.stops);
        const LawFit& found = selection.law();
        if (found.terms.memory == LawTerms::Memory::none && !found.terms.relaxation && !found.terms.curve) return;
        const GroupError error = errorOf(found.law, 0);
        if (!(error.identification < 0.5 * result_.error_after.identification) ||
            !(error.validation < 0.5 * result_.error_after.validation))
            return;
        result_.causes.clear();
        result_.adjustments.clear();
        // Against the best set of the catalogue, by the same criterion: the sample size of the closer law, half a
        // logarithm of it for each number.
        const double samples = std::max(2.0, found.effective_samples);
        const double log_odds = samples * std::log(result_.error_after.identification / error.identification) -
                                0.5 * found.parameter_count * std::log(samples);
        const double probability = std::min(0.999, 1 / (1 + std::exp(-std::clamp(log_odds, -50.0, 50.0))));
        Decision decision;
        decision.action = "law along the motion: " + found.terms.name();
        decision.error = error.validation;
        if (result_.noise_floor.identification > 0)
            decision.misfit = {std::pow(error.identification / result_.noise_floor.identification, 2)};
        const auto add = [&](const std::string& cause, const std::vector<std::string>& keys) {
            Cause named;
            named.cause = cause;
            named.probability = probability;
            named.where = {problem_.place()};
            named.gain_db = toDecibel(result_.error_after.validation / error.validation);
            for (const ComponentParameter& p : found.parameters)
                for (const std::string& key : keys)
                    if (p.name.rfind(problem_.place() + "." + key, 0) == 0)
                        named.parameters.push_back({p.name, p.unit, p.value, p.lower, p.upper});
            decision.causes.push_back(cause + " " + problem_.place());
            result_.causes.push_back(std::move(named));
        };
        if (found.terms.memory != LawTerms::Memory::none)
            add(found.terms.memory == LawTerms::Memory::hysteresis || found.terms.memory == LawTerms::Memory::sliders
                    ? "hysteresis"
                    : "friction",
                {"sliding", "hysteresis", "yield", "gap"});
        if (found.terms.relaxation) add("relaxation", {"stiffness of all"});
        if (found.terms.curve) add("force_curve", {"stiffness at the"});
        result_.decisions.push_back(std::move(decision));
        result_.error_after = error;
        const std::vector<Stop> believed = model_.connections[connection_].axis[axis_].stops;
        law_ = found.law;
        if (law_.stops.empty()) law_.stops = believed;  // what the tests do not reach
    }

    void noteDelay() {
        const bool named = std::any_of(answer_.best.set.begin(), answer_.best.set.end(),
                                       [&](int h) { return at(h).cause == "sensor_delay"; });
        if (!named) return;
        result_.notes.push_back("force." + problem_.place() +
                                " is late by the delay named; a model has no place for it, so that the "
                                "extended model holds the law alone");
    }

    /// Whether what is left lies within contact, as a share of its power against the share of the samples.
    std::string findRegime() const {
        double inside = 0, all = 0;
        Eigen::Index contacts = 0, count = 0;
        for (const ComponentData& judge : problem_.judges()) {
            const Eigen::VectorXd error = calcForceError(law_, 0, judge);
            for (Eigen::Index k = 0; k < error.size(); ++k) {
                const bool contact = std::any_of(law_.stops.begin(), law_.stops.end(), [&](const Stop& stop) {
                    return (stop.side == Side::positive ? 1 : -1) * (judge.q[k] + law_.offset) > stop.clearance;
                });
                all += error[k] * error[k];
                if (contact) inside += error[k] * error[k];
                contacts += contact ? 1 : 0;
                ++count;
            }
        }
        const double share = static_cast<double>(contacts) / static_cast<double>(std::max<Eigen::Index>(1, count));
        return contacts > 0 && inside > 0.5 * (1 + share) * all ? "contact" : "free";
    }

    const MountModel& model_;
    std::size_t connection_, axis_;
    bool validated_;
    ElementProblem problem_;
    const DiagnosisOptions& options_;
    ResidualAnswer answer_;
    AxisLaw law_;
    Diagnosis result_;
};

}  // namespace

Diagnosis diagnoseComponent(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                            const MountModel& model, ComponentOptions options, const DiagnosisOptions& progress) {
    std::vector<std::string> notes;
    const std::vector<ComponentData> tests = extractAll(identification, model, options, notes);
    const std::vector<ComponentData> judges = extractAll(validation, model, options, notes);
    const std::size_t connection = findElement(model, tests.front().connection);
    const int axis = tests.front().axis;
    Diagnosis result = ElementDiagnostician(tests, judges, model, connection, axis, progress).run();
    result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
    return result;
}

}  // namespace wems::identify
