#include "identify/rig/rig_diagnosis.hpp"

#include <algorithm>
#include <utility>

#include "identify/residual/residual_diagnosis.hpp"
#include "identify/rig/rig_problem.hpp"

namespace wems::identify {
namespace {

/// `body.mass` → `mass`, `load.gain` → `gain`, as results name them.
std::string reportName(const std::string& name) {
    if (name == "body.mass") return "mass";
    return name == "load.gain" ? "gain" : name;
}

bool isSensorFault(const std::string& cause) {
    return cause.rfind("sensor_", 0) == 0;
}

}  // namespace

std::optional<Diagnosis> diagnoseRig(const std::vector<Recording>& identification,
                                     const std::vector<Recording>& validation, const MountModel& model,
                                     const DiagnosisOptions& options) {
    if (!findRigAxis(model)) return std::nullopt;
    const RigProblem problem(identification, validation, model);
    if (options.progress) options.progress("free response of the rig");
    ResidualDiagnosis found = diagnoseResidual(problem, options);
    Diagnosis& result = found.diagnosis;
    result.validated = !validation.empty();
    result.extended = problem.modelAt(found.answer.best.values);
    for (const RunMotion& motion : problem.motions())
        for (const auto& note : motion.notes)
            if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
                result.notes.push_back(note);
    for (Cause& cause : result.causes) {
        for (CauseParameter& p : cause.parameters) p.name = reportName(p.name);
        for (Rival& rival : cause.rivals)
            for (CauseParameter& p : rival.parameters) p.name = reportName(p.name);
        if (!isSensorFault(cause.cause) || cause.parameters.empty()) continue;
        SensorFault fault;
        fault.channel = cause.where.front();
        (cause.cause == "sensor_gain" ? fault.gain : fault.delay) = cause.parameters.front().value;
        result.extended.sensors.push_back(fault);
    }
    result.verdict = judgeVerdict(result);
    if (result.verdict == Diagnosis::Verdict::unexplained)
        for (const Connection& connection : model.connections)
            result.unexplained_where.push_back(connection.name + "." + "xyz"[problem.axis()]);
    return std::move(found.diagnosis);
}

}  // namespace wems::identify
