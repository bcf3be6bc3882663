#include "identify/commands/element_report.hpp"

#include "identify/commands/diagnosis_output.hpp"
#include "identify/component/component_fit.hpp"
#include "models/report/html_report.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify::commands {
namespace {

std::vector<double> toVector(const Eigen::VectorXd& values) {
    return {values.begin(), values.end()};
}

/// Of one axis of a model along a test, with the constant force that the test has.
Eigen::VectorXd calcForce(const MountModel& model, const ComponentData& test) {
    const Connection& connection = model.connections[findElement(model, test.connection)];
    const AxisLaw& law = connection.axis.at(test.axis);
    Eigen::VectorXd force = calcForceAlong(law, test.time, test.q, test.velocity);
    force.array() += test.force.mean() - force.mean();
    return force;
}

void addTest(const Recording& recording, const DiagnoseAnswer& answer, const std::string& role, HtmlReport& page) {
    const ComponentData test = extractComponent(recording, completeOptions(recording, answer.model, {}));
    const std::vector<double> q = toVector(1e3 * test.q), time = toVector(test.time);
    const std::vector<double> measured = toVector(test.force), believed = toVector(calcForce(answer.model, test)),
                              extended = toVector(calcForce(answer.extended, test));
    page.addPlot({"Force over displacement, " + role + ": " + test.file,
                  "displacement [mm]",
                  "force [N]",
                  {{"measured", q, measured}, {"as modelled", q, believed}, {"extended", q, extended}},
                  true});
    page.addPlot({"Force over time, " + role + ": " + test.file,
                  "time [s]",
                  "force [N]",
                  {{"measured", time, measured}, {"as modelled", time, believed}, {"extended", time, extended}}});
}

}  // namespace

void writeElementReport(const DiagnoseAnswer& answer, const std::string& file, OutputFiles& outputs) {
    const Diagnosis& diagnosis = answer.diagnosis;
    HtmlReport page("Element on a test machine: " + answer.title);
    std::string verdict = "Verdict: " + formatVerdict(diagnosis.verdict) + ".";
    if (!diagnosis.unexplained_where.empty()) {
        verdict += " What is left sits at:";
        for (const std::string& place : diagnosis.unexplained_where) verdict += " " + place;
        verdict += ".";
    }
    page.addText(verdict);
    if (!diagnosis.validated)
        page.addText(
            "There were no validation tests: those of the identification judge themselves, which flatters every "
            "cause.");
    page.addTable({"force", "error before", "adjusted", "error after", "noise alone"}, tabulateErrors(diagnosis));
    if (!diagnosis.causes.empty())
        page.addTable({"cause", "probability", "gain [dB]", "parameter", "value", "95 % interval", "unit"},
                      tabulateCauses(diagnosis));
    if (!diagnosis.adjustments.empty())
        page.addTable({"number", "believed", "±", "value", "95 % interval", "unit"}, tabulateAdjustments(diagnosis));
    for (const Recording& recording : answer.identification) addTest(recording, answer, "identification", page);
    for (const Recording& recording : answer.validation) addTest(recording, answer, "validation", page);
    for (const auto& note : diagnosis.notes) page.addText(note);
    page.write(file, outputs);
}

}  // namespace wems::identify::commands
