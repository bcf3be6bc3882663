// The Python module `wems._simbody`: simulations with Simbody, response curves, modes.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identify/python/bindings.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording.hpp"
#include "plugin/linear_analysis.hpp"
#include "plugin/prescribed_motion.hpp"
#include "plugin/response_command.hpp"
#include "plugin/run_settings.hpp"
#include "plugin/simulation.hpp"

namespace wems::python {
namespace {

using identify::commands::Watcher;
using namespace plugin;

/// As identify/python/module.cpp does it: the module of an exception's type is not that of this one.
void translateErrors(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
        const py::object type = py::module_::import("wems.errors").attr("InputError");
        const InputLocation& at = error.location();
        const py::object raised = type(error.what(), at.file, at.line, at.key, error.problem(), error.accepted());
        PyErr_SetObject(type.ptr(), raised.ptr());
    }
}

/// @param words of the program's command line, without the model
SimulateOptions parseWords(const std::vector<std::string>& words) {
    std::vector<const char*> argv{"simulate", "model"};
    for (const std::string& word : words) argv.push_back(word.c_str());
    auto options = readOptions(static_cast<int>(argv.size()), argv.data());
    if (!options) throw InputError({}, "asks for help", "an excitation");
    return *std::move(options);
}

/// Text and data of an answer, as the package's Result asks for them.
struct Answer {
    std::string json, text;
    std::function<void(const std::string&)> report;
};

std::shared_ptr<Recording> simulateWith(const std::shared_ptr<MountModel>& given,
                                        const std::shared_ptr<Recording>& drive, std::vector<std::string> words,
                                        const py::object& progress) {
    const auto model = std::make_shared<const MountModel>(*given);
    if (drive) words.insert(words.end(), {"--from-csv", drive->file.empty() ? "recording" : drive->file});
    const SimulateOptions options = parseWords(words);
    return follow(progress, [&](Watcher& watcher) {
        const Excitation excitation = drive ? makeReplay(*drive, options, model->sensors) : makeExcitation(options, {});
        if (excitation.times.empty())
            throw InputError({}, "the run has no sample", "a duration above the sample interval");
        SimulationSettings settings = makeSettings(options, excitation);
        const double end = excitation.times.back();
        double said = 0;
        watcher.onStep({"simulation"});
        settings.progress = [&](double t) {
            constexpr double often = 0.005;  // of the run
            if (t - said < often * end) return;
            said = t;
            watcher.onProgress(t / end, "simulation");
        };
        SimulationResult result = plugin::simulate(*model, excitation.drive, settings);
        auto recording = std::make_shared<Recording>(std::move(result.recording));
        const auto channels =
            makeSensorChannels(*model, options.channels, excitation.drive->hasLoad(), excitation.drive->hasBase());
        recording->metadata = makeHeader(options, *model, excitation, channels).metadata;
        recording->file = "simulation of " + model->name;
        recording->format = "simulation";
        for (double& t : recording->time) t += excitation.time_offset;
        return recording;
    });
}

/// The forces of a model's laws along a recorded motion.
std::shared_ptr<Recording> moveAlong(const std::shared_ptr<MountModel>& model,
                                     const std::shared_ptr<Recording>& motion) {
    auto recording = std::make_shared<Recording>(followMotion(*model, *motion).recording);
    recording->file = "forces of " + model->name + " along " + motion->file;
    recording->format = "simulation";
    return recording;
}

/// The load or base acceleration alone, as a recording.
std::shared_ptr<Recording> excite(const std::vector<std::string>& words) {
    const Excitation excitation = makeExcitation(parseWords(words), {});
    auto recording = std::make_shared<Recording>();
    recording->file = excitation.description;
    recording->format = "excitation";
    const auto add = [&](const char* first, const char* unit, Eigen::Vector3d (Drive::*calc)(double) const) {
        for (int axis = 0; axis < 3; ++axis) {
            Channel channel;
            channel.name = first + std::string(1, "xyz"[axis]);
            channel.unit = unit;
            for (const double t : recording->time) channel.values.push_back(((*excitation.drive).*calc)(t)[axis]);
            recording->channels.push_back(std::move(channel));
        }
    };
    for (std::size_t k = 0; k < excitation.times.size(); ++k) recording->time.push_back(excitation.times[k]);
    if (excitation.drive->hasLoad()) add("load.f", "N", &Drive::calcLoad);
    if (excitation.drive->hasBase()) add("base.a", "m/s^2", &Drive::calcBaseAcceleration);
    return recording;
}

Answer calcResponse(const std::shared_ptr<MountModel>& given, const std::vector<std::string>& words,
                    const py::object& progress) {
    const auto model = std::make_shared<const MountModel>(*given);
    const SimulateOptions options = parseWords(words);
    const auto levels = std::make_shared<const std::vector<LevelResponse>>(follow(progress, [&](Watcher& watcher) {
        return calcResponses(*model, options, [&](double done, const std::string& level, double, int) {
            watcher.onProgress(done, level);
        });
    }));
    nlohmann::json result = makeResponseJson(*model, *levels);
    addRecord(result, makeRecord(options, "response", *model, true));
    return {result.dump(), formatResponses(*model, *levels, TextStyle::plain),
            [model, levels](const std::string& file) {
                OutputFiles outputs;
                writeResponseReport(*model, *levels, file, outputs);
                outputs.commit();
            }};
}

Answer calcModes(const std::shared_ptr<MountModel>& given, const std::vector<std::string>& words,
                 const py::object& progress) {
    const MountModel model = *given;
    const SimulateOptions options = parseWords(words);
    const auto analysis = std::make_shared<const LinearAnalysis>(
        follow(progress, [&](Watcher&) { return analyseLinearly(model, makeQuestion(options)); }));
    nlohmann::json result = makeAnalysisJson(*analysis);
    addRecord(result, makeRecord(options, "modes", model, true));
    return {result.dump(), formatAnalysis(*analysis, TextStyle::plain), [analysis](const std::string& file) {
                OutputFiles outputs;
                writeAnalysisReport(*analysis, {}, file, outputs);  // a model in memory has no drawing
                outputs.commit();
            }};
}

}  // namespace
}  // namespace wems::python

PYBIND11_MODULE(_simbody, module) {
    using namespace wems::python;
    py::module_::import("wems._wems");  // knows recordings and models
    py::register_exception_translator(&translateErrors);
    py::class_<Answer>(module, "Answer", py::module_local())  // wems._wems has one of its own
        .def("json", [](const Answer& self) { return self.json; })
        .def("text", [](const Answer& self) { return self.text; })
        .def("report", [](const Answer& self, const std::string& file) { self.report(file); });
    module.def("simulate", &simulateWith);
    module.def("move_along", &moveAlong);
    module.def("excite", &excite);
    module.def("response", &calcResponse);
    module.def("modes", &calcModes);
}
