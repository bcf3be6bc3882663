// What the simulation gets wrong, the named causes, the extended model, the gain.
#include "identify/commands/diagnose.hpp"

#include <algorithm>
#include <utility>

#include "identify/commands/diagnosis_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/component/component_diagnosis.hpp"
#include "identify/component/component_fit.hpp"
#include "identify/diagnose/diagnose.hpp"
#include "models/common/error.hpp"
#include "models/mount_model.hpp"
#include "models/report/html_report.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify::commands {

namespace {

/// Tests of one element; false if the first recording is of a device.
bool readElementTests(const RunSelection& runs, const ColumnMap* map, DiagnoseAnswer& answer) {
    for (const auto& [sources, group] :
         {std::pair(&runs.recordings, &answer.identification), std::pair(&runs.validation, &answer.validation)})
        for (const RecordingSource& source : *sources) {
            Recording recording = readSource(source, map);
            if (!isComponentTest(recording)) {
                if (answer.identification.empty()) return false;
                throw InputError({source.file, 0, ""}, "a component test and a recording of a whole device",
                                 "recordings of one kind in one diagnosis");
            }
            group->push_back(std::move(recording));
        }
    return true;
}

}  // namespace

DiagnoseAnswer runDiagnosis(DiagnoseRequest request, Watcher& watcher) {
    DiagnoseAnswer answer;
    RunSelection& runs = request.runs;
    answer.record = beginRecord("diagnose");
    resolveRuns(runs);
    answer.model = readDeviceModel(runs.model, runs.geometry);
    answer.title = answer.model.name.empty() ? runs.model.file : answer.model.name;
    addInputs(answer.record, runs, answer.model);
    answer.record.tolerances = listTolerances(answer.model);
    watcher.onInputs(listFiles(answer.record));
    const std::optional<ColumnMap> map = readDeviceMap(runs.columns, answer.model);
    if (map) answer.record.addColumns(*map);
    for (const RecordingSource& judge : runs.validation)
        for (const RecordingSource& fitted : runs.recordings)
            if (judge.file == fitted.file && judge.loaded == fitted.loaded)
                answer.warnings.push_back(judge.file + " is fitted to and judges too, which flatters every cause");
    watcher.onStep({"reading"});
    DiagnosisOptions options;
    if (readElementTests(runs, map ? &*map : nullptr, answer)) {
        answer.element = true;
        ComponentOptions component;
        component.time_known = !map || map->has_time || map->sample_interval != 1;
        options.progress = [&](const ProgressEvent& step) { watcher.onStep(step); };
        answer.diagnosis =
            diagnoseComponent(answer.identification, answer.validation, answer.model, component, options);
        answer.extended = answer.diagnosis.extended;
        answer.notes = makeAdmissible(answer.model, answer.extended);
        return answer;
    }
    answer.identification = readDeviceRecordings(runs.recordings, runs.columns, answer.model);
    answer.validation = readDeviceRecordings(runs.validation, runs.columns, answer.model);
    checkFitStart(answer.model, runs.model.file);
    for (const auto* group : {&answer.identification, &answer.validation}) {
        checkSampleRate(*group, answer.model);
        checkDisplacements(*group, answer.model);
    }
    // How many rounds there will be is not known.
    options.progress = [&](const ProgressEvent& step) { watcher.onStep(step); };
    answer.diagnosis = diagnose(answer.identification, answer.validation, answer.model, options);
    answer.extended = answer.diagnosis.extended;
    answer.notes = makeAdmissible(answer.model, answer.extended);
    return answer;
}

nlohmann::json toJson(const DiagnoseAnswer& answer) {
    nlohmann::json result = makeDiagnosisJson(answer.diagnosis);
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const DiagnoseAnswer& answer, TextStyle style) {
    std::string text;
    for (const auto* group : {&answer.identification, &answer.validation})
        for (const auto& recording : *group)
            for (const auto& warning : recording.warnings) text += recording.file + ": " + warning + "\n";
    text += formatDiagnosis(answer.diagnosis, style);
    for (const Cause& cause : answer.diagnosis.causes)
        for (const std::string& place : cause.where)
            if (const std::string* column = findColumn(answer.record.columns, place))
                text += place + " is the column '" + *column + "'\n";
    return text;
}

void writeReport(const DiagnoseAnswer& answer, const std::string& file, OutputFiles& outputs) {
    if (answer.element) return writeElementReport(answer, file, outputs);
    writeDiagnosisReport(answer.diagnosis, answer.model, {answer.identification, answer.validation}, answer.title, file,
                         outputs);
}

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
