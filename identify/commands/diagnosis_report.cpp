#include <algorithm>
#include <iterator>

#include "identify/commands/device_scene.hpp"
#include "identify/commands/diagnosis_output.hpp"
#include "identify/commands/format.hpp"
#include "identify/commands/restoring_forces.hpp"
#include "identify/commands/run_pictures.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/common/format_number.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {
namespace {

/// What the verdict rests on, as a sentence that can be read alone.
std::string describeErrors(const Diagnosis& diagnosis) {
    const auto group = diagnosis.validated ? &GroupError::validation : &GroupError::identification;
    std::string text = "A free simulation of the ";
    text += diagnosis.validated ? "validation" : "identification";
    text += " recordings errs by " + formatPercent(diagnosis.error_before.*group) + " with the model as given";
    if (!diagnosis.causes.empty())
        text += " and by " + formatPercent(diagnosis.error_after.*group) + " with the causes below";
    text += "; noise alone would leave " + formatPercent(diagnosis.noise_floor.*group) + ".";
    if (diagnosis.verdict == Diagnosis::Verdict::unexplained)
        text += " No cause of the catalogue explains what is left.";
    return text;
}

void addErrors(const Diagnosis& diagnosis, HtmlReport& page) {
    page.addHeading("Free simulation against the recordings");
    std::vector<std::string> columns{"recordings", "error before", "error after", "noise alone"};
    if (usesTolerances(diagnosis)) columns.insert(columns.begin() + 2, "adjusted");
    page.addTable(columns, tabulateErrors(diagnosis));
    page.addText("Equations of motion along the measured motion of the validation recordings: misfit " +
                 formatNumber(diagnosis.misfit_before, 4) + " before, " + formatNumber(diagnosis.misfit_after, 4) +
                 " after; noise alone leaves 1.");
    if (diagnosis.prediction_band) page.addText(describeAllowed(diagnosis, "recordings"));
    if (!diagnosis.validated)
        page.addText(
            "There were no validation recordings: the identification recordings judged themselves, which flatters "
            "every cause.");
}

void addCauses(const Diagnosis& diagnosis, HtmlReport& page) {
    page.addHeading("Causes");
    if (diagnosis.causes.empty()) {
        page.addText("None.");
        return;
    }
    page.addTable({"cause", "probability", "gain [dB]", "parameter", "value", "95 % interval", "unit"},
                  tabulateCauses(diagnosis));
    page.addText(
        "Values are the new ones, not the change. A cause is named from a probability of 0.5 on; its gain is what the "
        "error grows by without it, all others fitted again.");
    std::vector<std::vector<std::string>> ties;
    for (const auto& cause : diagnosis.causes)
        for (const auto& rival : cause.rivals) {
            std::vector<std::string> values;
            for (const auto& p : rival.parameters)
                values.push_back(p.name + " = " + formatNumber(p.value) + (p.unit == "-" ? "" : " " + p.unit));
            ties.push_back(
                {cause.cause, rival.cause, joinWords(rival.where, " "), joinWords(values, ", "), rival.separate_by});
        }
    if (ties.empty()) return;
    page.addHeading("What these data cannot tell apart");
    page.addTable({"named", "rival", "where", "the rival's parameters", "what would separate them"}, ties);
}

void addAdjustments(const Diagnosis& diagnosis, HtmlReport& page) {
    if (diagnosis.adjustments.empty()) return;
    page.addHeading("Adjustments: numbers that moved within their tolerance");
    page.addTable({"number", "believed", "±", "value", "95 % interval", "unit"}, tabulateAdjustments(diagnosis));
}

void addDecisions(const Diagnosis& diagnosis, HtmlReport& page) {
    if (diagnosis.decisions.empty()) return;
    page.addHeading("Why: the rounds of the selection");
    page.addText(
        usesTolerances(diagnosis)
            ? "Exact numbers with a cause or two left a part of the error, so that every number was allowed its "
              "tolerance. In each round every cause of the catalogue is weighed at every place, all tolerances "
              "adjusted along with it. Log odds are those of the causes taken so far with the candidate, over "
              "those without."
            : "All numbers are taken as exact but those of the causes. In each round every cause of the "
              "catalogue is weighed at every place, and the best few are fitted. Log odds are those of the "
              "causes taken so far with the candidate, over those without, before it was fitted.");
    page.addText(
        "Log evidence is that of a fitted set over the set that the round began with. The error of the "
        "prediction is given where it was simulated.");
    for (std::size_t r = 0; r < diagnosis.decisions.size(); ++r) {
        page.addText("Round " + std::to_string(r + 1) + ": " + describeDecision(diagnosis.decisions[r]) + ".");
        const auto rows = tabulateCandidates(diagnosis.decisions[r]);
        if (!rows.empty()) page.addTable({"candidate", "where", "log odds"}, rows);
        const auto fitted = tabulateFitted(diagnosis.decisions[r]);
        if (!fitted.empty()) page.addTable(kFittedColumns, fitted);
    }
}

void addSpectrum(const Diagnosis& diagnosis, HtmlReport& page) {
    if (diagnosis.spectrum.frequency.empty()) return;
    Plot plot{"Misfit of the mount's equation of motion, recordings that judge",
              "frequency [Hz]",
              "misfit per value [-]",
              {},
              false,
              true};
    plot.series.push_back({"before", diagnosis.spectrum.frequency, diagnosis.spectrum.before, false, kBeforeColor});
    plot.series.push_back({"after", diagnosis.spectrum.frequency, diagnosis.spectrum.after, false, kAfterColor});
    page.addPlot(plot);
}

/// What no cause describes, beside the believed law: a stop's force would hide it.
void addElasticLaws(const Diagnosis& diagnosis, HtmlReport& page) {
    for (const ElasticLaw& law : diagnosis.elastic_laws) {
        std::vector<double> displacement, beyond, lower, upper;
        for (std::size_t i = 0; i < law.displacement.size(); ++i) {
            displacement.push_back(1e3 * law.displacement[i]);
            beyond.push_back(law.force[i] - law.believed[i]);
            lower.push_back(beyond.back() - kTwoSided95 * law.deviation[i]);
            upper.push_back(beyond.back() + kTwoSided95 * law.deviation[i]);
        }
        Plot plot{"Elastic force of " + law.where + " that no cause describes, beyond the believed law",
                  "relative displacement [mm]",
                  "force [N]",
                  {}};
        plot.series.push_back({"as the recordings have it", displacement, beyond, false, kAfterColor});
        plot.series.push_back({"95 % interval, lower", displacement, lower, true, kAfterColor});
        plot.series.push_back({"95 % interval, upper", displacement, upper, true, kAfterColor});
        page.addPlot(plot);
    }
}

/// Before and after: forces along all runs, free simulations of those that judged.
void addCurves(const Diagnosis& diagnosis, const MountModel& model, const DiagnosedRuns& runs, HtmlReport& page) {
    const auto named = findNamedAxis(diagnosis);
    const auto& judges = diagnosis.validated ? runs.validation : runs.identification;
    const auto judged = prepareJudgedRuns(judges, diagnosis, kMostDrawn);
    auto all = judged;
    if (diagnosis.validated) {
        auto fitted = prepareJudgedRuns(runs.identification, diagnosis, kMostDrawn);
        std::move(fitted.begin(), fitted.end(), std::back_inserter(all));
    }
    if (judged.size() < judges.size())
        page.addText("Of " + std::to_string(judges.size()) + " runs that judged, the first " +
                     std::to_string(judged.size()) + " are drawn.");
    std::vector<MovedRun> moved;
    for (const JudgedRun& run : all) moved.push_back({&run.motion, findSweptFrequency(run.recording)});
    addRestoringForces(page, moved, model, diagnosis.extended, "as extended", named);
    const GroupError& noise = diagnosis.noise_floor;
    addSimulatedRuns(page, judged, model, diagnosis.extended,
                     diagnosis.validated ? noise.validation : noise.identification, named);
}

}  // namespace

void writeDiagnosisReport(const Diagnosis& diagnosis, const MountModel& model, const DiagnosedRuns& runs,
                          const std::string& title, const std::string& file, OutputFiles& outputs) {
    HtmlReport page("Diagnosis of " + title);
    page.addLead(makeHeadline(diagnosis, model));
    page.addText("Verdict: " + formatVerdict(diagnosis.verdict) + ".");
    page.addText(describeErrors(diagnosis));
    if (!diagnosis.unexplained_where.empty())
        page.addText("What is left sits at: " + joinWords(diagnosis.unexplained_where, ", "));
    addCauses(diagnosis, page);
    addElasticLaws(diagnosis, page);
    addErrors(diagnosis, page);
    addMotion(page, makeDeviceScene(runs.identification, diagnosis.extended));
    addCurves(diagnosis, model, runs, page);
    addSpectrum(diagnosis, page);
    addAdjustments(diagnosis, page);
    addDecisions(diagnosis, page);
    page.addHeading("How the motion was obtained");
    page.addList(diagnosis.notes);
    page.write(file, outputs);
}

}  // namespace wems::identify::commands
