#include "identify/component/component_diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "identify/component/component_fit.hpp"
#include "identify/component/law_selection.hpp"
#include "models/model_tolerance.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {
namespace {

using Memory = LawTerms::Memory;

// A law that leaves less of the force than a data sheet's stiffness is off by answers for it (fit/law_verdict.hpp).
constexpr double kAnswered = 0.1;
// Another shape than the model's own is taken only where it leaves a tenth less: both fit the same noise.
constexpr double kBetter = 0.9;

std::vector<ComponentData> extractAll(const std::vector<Recording>& recordings, const MountModel& model,
                                      ComponentOptions& options) {
    std::vector<ComponentData> tests;
    for (const Recording& recording : recordings) {
        tests.push_back(extractComponent(recording, completeOptions(recording, model, options)));
        options.connection = tests.front().connection;
        options.axis = tests.front().axis;
    }
    return tests;
}

/// Mean of what a law leaves: the zero of the load cell.
double calcOffset(const AxisLaw& law, const std::vector<ComponentData>& tests) {
    double sum = 0;
    Eigen::Index count = 0;
    for (const ComponentData& test : tests) {
        sum += (test.force - calcForceAlong(law, test.time, test.q, test.velocity)).sum();
        count += test.count();
    }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// All that the comparison of a believed and a found law needs.
struct LawComparison {
    const MountModel& model;
    const Connection& connection;
    int axis;
    const AxisLaw& believed;
    const AxisLaw& found;
    const std::vector<ComponentData>& judges;
    double error;  ///< of the found law on the judges
    std::string place;

    double calcGain(const AxisLaw& without, double offset) const {
        const double worse = calcLawError(without, offset, judges);
        return error > 0 && worse > 0 ? 20 * std::log10(worse / error) : 0;
    }
};

CauseParameter toParameter(const ComponentParameter& p) {
    return {p.name, p.unit, p.value, p.lower, p.upper};
}

const ComponentParameter* findNamed(const std::vector<ComponentParameter>& parameters, const std::string& name) {
    for (const ComponentParameter& p : parameters)
        if (p.name == name) return &p;
    return nullptr;
}

/// One number of the law: nothing, an adjustment, or a cause.
void compareNumber(const LawComparison& c, const char* cause, const char* key, double AxisLaw::*member,
                   ToleranceOf what, const std::vector<ComponentParameter>& parameters, Diagnosis& result) {
    const double before = c.believed.*member, now = c.found.*member;
    const ComponentParameter* found = findNamed(parameters, c.place + key);
    if (found == nullptr || now == before) return;
    const Tolerances& own = c.connection.axis_tolerances[static_cast<std::size_t>(c.axis)];
    const double tolerance = toleranceOf(c.model, what, own) * std::abs(before);
    CauseParameter parameter = toParameter(*found);
    parameter.value = now;
    // Beyond the tolerance with its interval, too; a dashpot of no effect is none.
    const double beyond = now > before ? parameter.lower - before : before - parameter.upper;
    AxisLaw without = c.found;
    without.*member = before;
    const double gain = c.calcGain(without, calcOffset(without, c.judges));
    if (beyond <= tolerance || gain < 0.5) {
        result.adjustments.push_back({parameter, before, tolerance});
        return;
    }
    Cause named;
    named.cause = cause;
    named.probability = 0.99;
    named.gain_db = gain;
    named.where = {c.place.substr(0, c.place.size() - 1)};
    named.parameters = {parameter};
    result.causes.push_back(std::move(named));
}

/// Clearances and stiffnesses of the stops, in the order in which both laws list them.
void compareStops(const LawComparison& c, const std::vector<ComponentParameter>& parameters, Diagnosis& result) {
    for (std::size_t i = 0; i < std::min(c.believed.stops.size(), c.found.stops.size()); ++i) {
        const std::string side = c.place + (c.believed.stops[i].side == Side::positive ? "+" : "-");
        const auto compare = [&](const char* cause, const char* key, double Stop::*member, ToleranceOf what) {
            const ComponentParameter* found = findNamed(parameters, side + "." + key);
            if (found == nullptr) return;
            const double before = c.believed.stops[i].*member, now = found->value;
            const Tolerances& own = c.connection.axis_tolerances[static_cast<std::size_t>(c.axis)];
            const double tolerance = toleranceOf(c.model, what, own) * std::abs(before);
            const double beyond = now > before ? found->lower - before : before - found->upper;
            if (beyond <= tolerance) {
                result.adjustments.push_back({toParameter(*found), before, tolerance});
                return;
            }
            AxisLaw without = c.found;
            without.stops[i].*member = before;
            Cause named;
            named.cause = cause;
            named.probability = 0.99;
            named.gain_db = c.calcGain(without, calcOffset(without, c.judges));
            named.where = {side};
            named.parameters = {toParameter(*found)};
            result.causes.push_back(std::move(named));
        };
        compare("clearance", "clearance", &Stop::clearance, ToleranceOf::clearance);
        compare("stop_stiffness", "stiffness", &Stop::stiffness, ToleranceOf::stop_stiffness);
    }
}

/// A part that the found law has: its name as a cause, and the terms without it.
struct FoundPart {
    std::string cause;
    LawTerms without;
    std::vector<std::string> keys;  ///< beginnings of the names of its parameters
};

std::vector<FoundPart> listParts(const LawTerms& terms) {
    std::vector<FoundPart> parts;
    if (terms.memory != Memory::none) {
        LawTerms without = terms;
        without.memory = Memory::none;
        const bool gap = terms.memory == Memory::gap_slider;
        parts.push_back({gap ? "friction" : "hysteresis", without, {"sliding", "hysteresis", "yield", "gap"}});
    }
    if (terms.relaxation) {
        LawTerms without = terms;
        without.relaxation = false;
        parts.push_back({"relaxation", without, {"stiffness of all"}});
    }
    if (terms.cubic) {
        LawTerms without = terms;
        without.cubic = false;
        parts.push_back({"cubic_stiffness", without, {"cubic"}});
    }
    return parts;
}

void addPartCauses(const LawComparison& c, const LawFit& found, const std::vector<ComponentData>& tests,
                   const std::vector<Stop>& stops, Diagnosis& result) {
    for (const FoundPart& part : listParts(found.terms)) {
        const LawFit without = fitLaw(tests, part.without, stops, c.place);
        const double samples = std::max(2.0, found.effective_samples);
        const double log_odds =
            samples * std::log(std::max(without.fraction, 1e-12) / std::max(found.fraction, 1e-12)) -
            0.5 * (found.parameter_count - without.parameter_count) * std::log(samples);
        Cause named;
        named.cause = part.cause;
        named.probability = 1 / (1 + std::exp(-std::clamp(log_odds, -50.0, 50.0)));
        named.gain_db = c.calcGain(without.law, without.force_offset);
        named.where = {c.place.substr(0, c.place.size() - 1)};
        for (const ComponentParameter& p : found.parameters)
            for (const std::string& key : part.keys)
                if (p.name.rfind(c.place + key, 0) == 0) named.parameters.push_back(toParameter(p));
        result.causes.push_back(std::move(named));
    }
}

}  // namespace

Diagnosis diagnoseComponent(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                            const MountModel& model, ComponentOptions options) {
    const ComponentFit own = fitComponent(identification, model, options);
    const std::vector<ComponentData> tests = extractAll(identification, model, options);
    std::vector<ComponentData> judges = extractAll(validation, model, options);
    Diagnosis result;
    result.validated = !judges.empty();
    if (judges.empty()) judges = tests;
    const auto at = static_cast<std::size_t>(own.axis);
    std::size_t index = 0;
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        if (model.connections[i].name == own.connection) index = i;
    const Connection& connection = model.connections[index];
    const AxisLaw& believed = connection.axis[at];
    const auto errors = [&](const AxisLaw& law) {
        const double offset = calcOffset(law, tests);
        return GroupError{calcLawError(law, offset, tests), calcLawError(law, calcOffset(law, judges), judges)};
    };
    result.error_before = errors(believed);

    const AxisLaw& refitted = own.fitted.connections[index].axis[at];
    std::vector<Stop> stops;
    const std::string place = own.connection + "." + "xyz"[own.axis] + ".";
    for (const Stop& stop : refitted.stops) {
        const std::string name = place + (stop.side == Side::positive ? "+" : "-") + ".stiffness";
        if (stop.stiffness > 0 && findNamed(own.parameters, name) != nullptr) stops.push_back(stop);
    }
    const LawSelection selection = selectLaw(tests, stops);
    const LawFit& found = selection.law();
    const GroupError error_refitted = errors(refitted);
    const GroupError error_found{calcLawError(found.law, found.force_offset, tests),
                                 calcLawError(found.law, found.force_offset, judges)};
    const bool other = error_found.identification < kBetter * error_refitted.identification &&
                       error_found.validation < error_refitted.validation;
    result.error_after = other ? error_found : error_refitted;
    result.error_adjusted = result.error_before;
    AxisLaw law = other ? found.law : refitted;
    if (other) {
        // Stops that the tests do not reach stay as the model has them.
        law.stops = refitted.stops;
        for (Stop& stop : law.stops)
            for (const Stop& fitted : found.law.stops)
                if (fitted.side == stop.side && fitted.clearance == stop.clearance) stop.stiffness = fitted.stiffness;
    }
    result.extended = own.fitted;
    result.extended.connections[index].axis[at] = law;

    const LawComparison comparison{model, connection, own.axis, believed, law, judges, result.error_after.validation,
                                   place};
    const auto& parameters = other ? found.parameters : own.parameters;
    compareNumber(comparison, "elastomer_stiffness", "stiffness", &AxisLaw::stiffness, ToleranceOf::stiffness,
                  parameters, result);
    compareNumber(comparison, "viscous_damping", "damping", &AxisLaw::damping, ToleranceOf::damping, parameters,
                  result);
    compareStops(comparison, own.parameters, result);
    if (other) addPartCauses(comparison, found, tests, stops, result);
    std::sort(result.causes.begin(), result.causes.end(),
              [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
    for (std::size_t i = 0; i < selection.tried.size(); ++i)
        result.decisions.push_back({"tried " + selection.tried[i].terms.name() + ": leaves " +
                                        std::to_string(100 * selection.tried[i].fraction).substr(0, 5) + " %",
                                    {},
                                    -0.5 * selection.information[i],
                                    {},
                                    selection.tried[i].fraction,
                                    {}});
    const bool answered = result.error_after.validation < kAnswered;
    using Verdict = Diagnosis::Verdict;
    result.verdict = !answered               ? Verdict::unexplained
                     : result.causes.empty() ? Verdict::nothing_missing
                                             : Verdict::explained;
    if (!answered) result.unexplained_where = {place.substr(0, place.size() - 1)};
    return result;
}

}  // namespace wems::identify
