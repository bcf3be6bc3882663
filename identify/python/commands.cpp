// The commands as functions of the module: keywords in, an Answer out.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/commands/compare.hpp"
#include "identify/commands/diagnose.hpp"
#include "identify/commands/fast_simulation.hpp"
#include "identify/commands/fit.hpp"
#include "identify/commands/inspect.hpp"
#include "identify/commands/plan.hpp"
#include "identify/commands/rigidity.hpp"
#include "identify/commands/schemas.hpp"
#include "identify/commands/spectra.hpp"
#include "identify/python/bindings.hpp"

namespace wems::python {
namespace {

using namespace identify;
using namespace identify::commands;

/// What a command found, in the forms that the command line gives it; each is made when it is asked for.
struct Answer {
    std::function<std::string()> json, text;
    std::function<void(const std::string&)> report;
    std::shared_ptr<MountModel> model;  ///< fitted or extended; null where the command makes none
};

template <class Found>
Answer wrap(Found found) {
    const auto kept = std::make_shared<const Found>(std::move(found));
    return {[kept] { return toJson(*kept).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace); },
            [kept] { return formatText(*kept, TextStyle::plain); },
            [kept](const std::string& file) {
                OutputFiles outputs;
                writeReport(*kept, file, outputs);
                outputs.commit();
            },
            nullptr};
}

// As the package hands them over: a name, and the object unless it is a file.
using RecordingArgument = std::pair<std::string, std::shared_ptr<Recording>>;
using ModelArgument = std::pair<std::string, std::shared_ptr<MountModel>>;

RecordingSource makeSource(const RecordingArgument& argument) {
    return {argument.first, argument.second};
}
ModelSource makeSource(const ModelArgument& argument) {
    // A copy: the caller may change the model while the command works.
    return {argument.first, argument.second ? std::make_shared<const MountModel>(*argument.second) : nullptr};
}
std::vector<RecordingSource> makeSources(const std::vector<RecordingArgument>& arguments) {
    std::vector<RecordingSource> sources;
    for (const RecordingArgument& argument : arguments) sources.push_back(makeSource(argument));
    return sources;
}

struct RunArguments {
    std::vector<RecordingArgument> recordings, validation;
    ModelArgument model;
    std::string test, columns, geometry;

    RunSelection select() const {
        return {makeSources(recordings), makeSources(validation), makeSource(model), test, columns, geometry};
    }
};

Answer fit(const RunArguments& runs, const std::vector<std::string>& free, const std::string& method,
           const std::string& use, double memory, const std::string& connection, const std::string& axis,
           std::optional<double> mass, std::optional<double> from, std::optional<double> to, const std::string& law,
           bool timing, const py::object& progress) {
    FitRequest request;
    request.runs = runs.select();
    request.fit.free_body = free;
    request.method = method;
    request.use = use;
    request.memory.megabytes = memory;
    request.component.connection = connection;
    if (!axis.empty()) request.component.axis = static_cast<int>(std::string("xyz").find(axis));
    request.component.mass = mass;
    request.component.from = from;
    request.component.to = to;
    request.law = law;
    request.timing = timing;
    request.keeps_runs = true;
    FitAnswer found = follow(progress, [&](Watcher& watcher) { return runFit(request, watcher); });
    const auto model = std::make_shared<MountModel>(found.fitted);
    Answer answer = wrap(std::move(found));
    answer.model = model;
    return answer;
}

Answer diagnose(const RunArguments& runs, const py::object& progress) {
    DiagnoseAnswer found = follow(progress, [&](Watcher& watcher) { return runDiagnosis({runs.select()}, watcher); });
    const auto model = std::make_shared<MountModel>(found.extended);
    Answer answer = wrap(std::move(found));
    answer.model = model;
    return answer;
}

using Band = std::optional<std::pair<double, double>>;
using Number = std::optional<double>;

Answer plan(const RunArguments& runs, Number force, Number acceleration, Number displacement, Number stroke,
            const Band& sweep, Number rate, std::size_t proposals, const std::vector<std::string>& free,
            const std::string& use, double memory, const py::object& progress) {
    PlanRequest request;
    request.runs = runs.select();
    request.plan.asked = {force, acceleration, displacement, stroke, sweep, rate};
    request.plan.most_proposals = proposals;
    request.plan.fit.free_body = free;
    request.use = use;
    request.memory.megabytes = memory;
    PlanAnswer found = follow(progress, [&](Watcher& watcher) { return runPlan(request, watcher); });
    const auto model = std::make_shared<MountModel>(found.fitted);
    Answer answer = wrap(std::move(found));
    answer.model = model;
    return answer;
}

Answer rigidity(const RecordingArgument& recording, const ModelArgument& model, const std::string& columns,
                const std::string& geometry, const py::object& progress) {
    const RigidityRequest request{makeSource(recording), makeSource(model), columns, geometry};
    return wrap(follow(progress, [&](Watcher& watcher) { return runRigidity(request, watcher); }));
}

Answer spectra(const std::vector<RecordingArgument>& recordings, const ModelArgument& model, const std::string& columns,
               const std::string& geometry, Number resolution, const std::string& reference, const Band& band, double q,
               const py::object& progress) {
    const SpectraRequest request{
        makeSources(recordings), makeSource(model), columns, geometry, {resolution, reference, band, q}};
    return wrap(follow(progress, [&](Watcher& watcher) { return runSpectra(request, watcher); }));
}

Answer compare(const RecordingArgument& measured, const RecordingArgument& simulated, const ModelArgument& model,
               const std::string& columns, const std::string& geometry, const py::object& progress) {
    const CompareRequest request{makeSource(measured), makeSource(simulated), makeSource(model), columns, geometry};
    return wrap(follow(progress, [&](Watcher& watcher) { return runCompare(request, watcher); }));
}

Answer inspect(const std::vector<RecordingArgument>& recordings, const ModelArgument& model, const std::string& columns,
               const std::string& geometry, double memory, const py::object& progress) {
    const InspectRequest request{makeSources(recordings), makeSource(model), columns, geometry, {memory}};
    return wrap(follow(progress, [&](Watcher& watcher) { return runInspect(request, watcher); }));
}

std::shared_ptr<Recording> simulateFast(const RecordingArgument& drive, const ModelArgument& model,
                                        const std::string& columns, const py::object& progress) {
    const FastSimulationRequest request{makeSource(drive), makeSource(model), columns};
    return std::make_shared<Recording>(
        follow(progress, [&](Watcher& watcher) { return runFastSimulation(request, watcher); }));
}

}  // namespace

void bindCommands(py::module_& module) {
    py::class_<Answer>(module, "Answer")
        .def("json", [](const Answer& self) { return self.json(); })
        .def("text", [](const Answer& self) { return self.text(); })
        .def(
            "report", [](const Answer& self, const std::string& file) { self.report(file); },
            py::call_guard<py::gil_scoped_release>())
        .def_readonly("model", &Answer::model);
    py::class_<RunArguments>(module, "Runs")
        .def(py::init([](std::vector<RecordingArgument> recordings, std::vector<RecordingArgument> validation,
                         ModelArgument model, std::string test, std::string columns, std::string geometry) {
            return RunArguments{std::move(recordings), std::move(validation), std::move(model),
                                std::move(test),       std::move(columns),    std::move(geometry)};
        }));
    module.def("fit", &fit);
    module.def("diagnose", &diagnose);
    module.def("plan", &plan);
    module.def("rigidity", &rigidity);
    module.def("spectra", &spectra);
    module.def("compare", &compare);
    module.def("inspect", &inspect);
    module.def("simulate_fast", &simulateFast);
    module.def("schema", [](const std::string& command) { return makeSchema(command).dump(); });
}

}  // namespace wems::python
