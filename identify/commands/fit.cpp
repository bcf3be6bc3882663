// Stiffness, clearance, stop stiffness and damping of each connection and axis, with intervals.
#include "identify/commands/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "identify/commands/component_fit.hpp"
#include "identify/commands/fit_output.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/component/component_data.hpp"
#include "identify/component/component_diagnosis.hpp"
#include "identify/fit/fit.hpp"
#include "identify/fit/law_verdict.hpp"
#include "identify/fit/output_error.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/updating/coarse_contacts.hpp"
#include "identify/updating/settling.hpp"
#include "models/common/error.hpp"
#include "models/mount_model.hpp"
#include "models/report/html_report.hpp"
#include "models/sampled_motion.hpp"
#include "models/sensor_reading.hpp"

namespace wems::identify::commands {
namespace {

constexpr double kReadingShare = 0.09, kMotionShare = 0.23;  // of the time when these steps are done, as measured

DeviceRuns estimateRuns(const FitRequest& request, const MountModel& model, std::vector<Recording>& recordings,
                        Watcher& watcher) {
    DeviceRuns result;
    for (Recording& recording : recordings) keepOnly(request.use, recording);
    result.runs.resize(recordings.size());
    watcher.onStep({"motion of both parts", kReadingShare, kMotionShare});
    runParallel(recordings.size(), [&](std::size_t r) { result.runs[r] = estimateMotion(recordings[r], model); });
    for (std::size_t r = 0; r < recordings.size(); ++r) {
        for (const auto& warning : recordings[r].warnings) result.notes.push_back(recordings[r].file + ": " + warning);
        for (const auto& note : result.runs[r].notes) result.notes.push_back(recordings[r].file + ": " + note);
    }
    return result;
}

/// A mount that feeds its motion is none: the recording runs backwards, or a sign is wrong.
void noteNegativeDamping(const FitResult& fit, std::vector<std::string>& notes) {
    const std::string ending = ".damping";
    long known = 0, negative = 0;
    std::string first;
    for (const FittedParameter& parameter : fit.parameters) {
        const std::string& name = parameter.name;
        if (name.size() < ending.size() || name.compare(name.size() - ending.size(), ending.size(), ending) != 0)
            continue;
        ++known;
        if (!(parameter.interval95[1] < 0)) continue;
        ++negative;
        if (first.empty()) first = name + " = " + formatNumber(parameter.value, 3) + " " + parameter.unit;
    }
    if (2 * negative > known)
        notes.push_back("the mount feeds the motion with energy (" + first +
                        " and others): does the time run backwards, or has a channel the wrong sign?");
}

/// Where derivatives do not hold, displacements can still be compared with a free simulation.
bool areTooCoarse(const std::vector<RunMotion>& runs) {
    return std::any_of(runs.begin(), runs.end(), [](const RunMotion& run) {
        return run.sufficient_rate > 0 && run.mobile.displacement_measured && !run.mobile.acceleration_measured;
    });
}

/// Displacements of the mobile part that all recordings hold.
std::vector<std::string> listDisplacements(const std::vector<Recording>& recordings) {
    std::vector<std::string> channels;
    for (const Channel& channel : recordings.front().channels) {
        const auto name = parseChannelName(channel.name);
        if (name && name->part == Part::mobile && name->derivative == Derivative::displacement &&
            std::all_of(recordings.begin(), recordings.end(),
                        [&](const Recording& other) { return other.find(channel.name) != nullptr; }))
            channels.push_back(channel.name);
    }
    return channels;
}

FitResult simulateFit(const FitRequest& request, const std::vector<Recording>& recordings,
                      const std::vector<RunMotion>& runs, const MountModel& model, Watcher& watcher) {
    watcher.onStep({"free simulations and their derivatives", kMotionShare, 1});
    constexpr double usual_steps = 12;
    FitResult fit =
        fitBySimulation(runs, model, request.fit, listDisplacements(recordings), [&](int step, double error) {
            watcher.onProgress(std::min(0.95, step / usual_steps),
                               "step " + std::to_string(step) + ", error " + formatPercent(error));
        });
    if (request.method == "auto")
        fit.notes.insert(fit.notes.begin(),
                         "sampled too coarsely for the equations of motion: fitted to free simulations "
                         "(--method motion takes the equations all the same)");
    return fit;
}

/// A regression's numbers refined where samples do not tell the course of its contacts.
std::optional<FitResult> refine(const FitResult& fit, const FitRequest& request,
                                const std::vector<Recording>& recordings, const std::vector<RunMotion>& runs,
                                const MountModel& model, Watcher& watcher) {
    if (recordings.empty() || !request.fit.free_body.empty() || !updating::hasCoarseContacts(fit, runs))
        return std::nullopt;
    watcher.onStep({"motion between the samples of a contact"});
    return updating::refineCoarseContacts(fit, recordings, model);
}

/// Derivatives that do not hold may do so with the motion between the samples of contacts, which no simulation follows
/// for long: that answer, if the equations then leave next to nothing but noise.
std::optional<FitResult> fitCoarseContacts(const FitRequest& request, const std::vector<Recording>& recordings,
                                           const std::vector<RunMotion>& runs, const MountModel& model,
                                           Watcher& watcher) {
    const bool has_stops = calcContactFrequency(model) > 0;
    if (!has_stops) return std::nullopt;
    try {
        auto refined = refine(fitMount(runs, model, request.fit), request, recordings, runs, model, watcher);
        if (refined && std::pow(refined->residual_over_noise, 2) < updating::kSatisfied) return refined;
    } catch (const InputError&) {
        // What the equations of motion lack, as length, a simulation may not need.
    }
    return std::nullopt;
}

FitResult fitRuns(const FitRequest& request, const std::vector<Recording>& recordings,
                  const std::vector<RunMotion>& runs, const MountModel& model, Watcher& watcher) {
    if (request.method == "simulation") return simulateFit(request, recordings, runs, model, watcher);
    if (request.method == "auto" && areTooCoarse(runs)) {
        if (const auto refined = fitCoarseContacts(request, recordings, runs, model, watcher)) return *refined;
        return simulateFit(request, recordings, runs, model, watcher);
    }
    const FitResult fit = fitMount(runs, model, request.fit);
    return refine(fit, request, recordings, runs, model, watcher).value_or(fit);
}

/// @param recordings of the runs; none where the runs are blocks of long ones
void fitDevice(const FitRequest& request, const std::vector<Recording>& recordings, DeviceRuns device, Watcher& watcher,
               FitAnswer& answer) {
    Stopwatch watch(answer.timing);
    answer.notes = std::move(device.notes);
    answer.blocks = std::move(device.blocks);
    watcher.onStep({"equations of motion, parameters and intervals", answer.blocks ? 0 : kMotionShare, 1});
    answer.mount = fitRuns(request, recordings, device.runs, answer.start, watcher);
    const FitResult& fit = *answer.mount;
    answer.notes.insert(answer.notes.end(), fit.notes.begin(), fit.notes.end());
    noteNegativeDamping(fit, answer.notes);
    answer.fitted = fit.model;
    const auto limited = makeAdmissible(answer.start, answer.fitted);
    if (request.wants_model || !request.runs.validation.empty())
        answer.notes.insert(answer.notes.end(), limited.begin(), limited.end());
    watch.restart();  // the fit has steps of its own
    answer.timing.insert(answer.timing.end(), fit.timing.begin(), fit.timing.end());
    if (!request.runs.validation.empty()) watcher.onStep({"free simulations of the validation runs"});
    answer.validation = validateModel(
        answer.fitted, readDeviceRecordings(request.runs.validation, request.runs.columns, answer.fitted));
    watch.lap("validation");
    if (!request.timing) answer.timing.clear();
    if (!request.keeps_runs) return;
    answer.runs = std::move(device.runs);
    answer.recordings = recordings;
}

AxisLaw& findLaw(ComponentFit& fit) {
    return fit.fitted.connections[findElement(fit.fitted, fit.connection)].axis.at(fit.axis);
}

/// The law that the tests show in place of the model's.
void adoptLaw(const LawFit& found, ComponentFit& fit) {
    findLaw(fit) = found.law;
    fit.parameters = found.parameters;
    fit.not_identifiable.clear();
    fit.residual_rms *= fit.residual_fraction > 0 ? found.fraction / fit.residual_fraction : 1;
    fit.residual_fraction = found.fraction;
    fit.force_offset = found.force_offset;
    fit.effective_samples = found.effective_samples;
    fit.notes.push_back("the law is what the tests show, not the model's: " + found.terms.name());
}

/// Force over displacement, as measured and as the fitted law has it along the measured motion.
Plot plotElement(const ComponentData& data, ComponentFit fit) {
    const Eigen::VectorXd q = 1e3 * data.q;
    const AxisLaw& law = findLaw(fit);
    Plot plot{"Force over displacement: " + data.file, "displacement [mm]", "force [N]", {}, true};
    plot.series.push_back({"measured", {q.begin(), q.end()}, {data.force.begin(), data.force.end()}});
    if (law.friction && !data.has_velocity) return plot;  // its direction is not in the data
    Series fitted{"fitted", {q.begin(), q.end()}, {}};
    for (const double f : calcForceAlong(law, data.time, data.q, data.velocity))
        fitted.y.push_back(f + fit.force_offset);
    plot.series.push_back(std::move(fitted));
    return plot;
}

void fitElement(const FitRequest& request, std::vector<Recording> recordings, const ColumnMap* map, FitAnswer& answer) {
    answer.element = fitComponent(recordings, answer.start, request.component);
    ComponentFit& fit = *answer.element;
    std::vector<ComponentData> tests;
    for (const Recording& recording : recordings)
        tests.push_back(extractComponent(recording, completeOptions(recording, answer.start, request.component)));
    const bool adopts = request.law == "found";
    if (adopts || judgeLaw(fit.residual_fraction, std::numeric_limits<double>::infinity()) != LawVerdict::identified) {
        const LawSelection found = selectLaw(tests, {});
        const LawFit& law = found.law();
        if (adopts)
            adoptLaw(law, fit);
        else if (law.fraction < fit.residual_fraction)
            fit.notes.push_back("the model's law leaves " + formatPercent(fit.residual_fraction) +
                                " of the force, a law with " + law.terms.name() + " " + formatPercent(law.fraction) +
                                ": --law found fits and writes that one");
    }
    for (const RecordingSource& source : request.runs.validation) {
        const Recording judge = readSource(source, map);
        const ComponentData test = extractComponent(judge, completeOptions(judge, answer.start, request.component));
        answer.validation.push_back({judge.file, calcLawError(findLaw(fit), fit.force_offset, test), ""});
    }
    for (const Recording& recording : recordings)
        for (const auto& warning : recording.warnings) fit.notes.push_back(recording.file + ": " + warning);
    answer.fitted = fit.fitted;
    const auto limited = makeAdmissible(answer.start, answer.fitted);
    if (request.wants_model) fit.notes.insert(fit.notes.end(), limited.begin(), limited.end());
    answer.component = request.component;
    if (request.keeps_runs) answer.recordings = std::move(recordings);
}

nlohmann::json describeOptions(const FitRequest& request) {
    nlohmann::json options = {{"free", request.fit.free_body},
                              {"method", request.method},
                              {"use", request.use},
                              {"memory_MB", request.memory.megabytes}};
    const ComponentOptions& element = request.component;
    if (!element.connection.empty()) options["connection"] = element.connection;
    if (element.axis) options["axis"] = std::string(1, "xyz"[*element.axis]);
    if (element.mass) options["mass"] = *element.mass;
    if (request.law != "model") options["law"] = request.law;
    if (element.from) options["from"] = *element.from;
    if (element.to) options["to"] = *element.to;
    return options;
}

void writeElementReport(const FitAnswer& answer, const std::string& file, OutputFiles& outputs) {
    const ComponentFit& fit = *answer.element;
    HtmlReport page("Identified element: connection " + fit.connection + ", axis " + "xyz"[fit.axis]);
    if (!fit.parameters.empty()) {
        const ComponentParameter& first = fit.parameters.front();
        const double radius = 0.5 * (first.upper - first.lower);
        page.addLead(first.name + " is " + formatNumber(first.value, 4) +
                     (std::isfinite(radius) && radius > 0 ? " ± " + formatNumber(radius, 2) : "") + " " + first.unit +
                     ".");
    }
    const Table table = tabulateParameters(fit.parameters);
    page.addTable(table.header(), table.rows());
    for (const Recording& recording : answer.recordings)
        page.addPlot(
            plotElement(extractComponent(recording, completeOptions(recording, answer.start, answer.component)), fit));
    for (const auto& note : fit.notes) page.addText(note);
    page.write(file, outputs);
}

}  // namespace

std::string FitAnswer::verdict() const {
    return toJson(*this).at("verdict");
}

FitAnswer runFit(FitRequest request, Watcher& watcher) {
    FitAnswer answer;
    answer.record = beginRecord("fit");
    Stopwatch watch(answer.timing);
    const auto campaign = resolveRuns(request.runs);
    answer.start = readDeviceModel(request.runs.model, request.runs.geometry);
    addInputs(answer.record, request.runs, answer.start);
    answer.record.options = describeOptions(request);
    watcher.onInputs(listFiles(answer.record));
    if (campaign)
        for (const RecordingSource& source : request.runs.validation)
            answer.validation_names.push_back(campaign->describe(source.file));
    const std::optional<ColumnMap> map = readDeviceMap(request.runs.columns, answer.start);
    if (map) answer.record.addColumns(*map);
    const std::vector<RecordingSource>& sources = request.runs.recordings;
    const bool asks_for_element = request.component.mass || request.component.axis;
    const auto size = estimateSize(sources, map ? &*map : nullptr);
    if (size && !size->component && !asks_for_element && request.method != "simulation" &&
        exceedsMemory(*size, answer.start, request.fit, request.memory)) {
        DeviceRuns device = chooseBlocks(sources, map ? &*map : nullptr, answer.start, request.fit, request.use, *size,
                                         request.memory, watcher);
        watch.lap("reading and choice of blocks");
        fitDevice(request, {}, std::move(device), watcher, answer);
        return answer;
    }
    std::vector<Recording> recordings;
    for (const RecordingSource& source : sources) {
        const auto all = static_cast<double>(sources.size()), read = static_cast<double>(recordings.size());
        watcher.onStep({"reading " + source.file, kReadingShare * read / all, kReadingShare * (read + 1) / all});
        recordings.push_back(readSource(source, map ? &*map : nullptr));
        if (isComponentTest(recordings.back()) != isComponentTest(recordings.front()))
            throw InputError({source.file, 0, ""}, "a component test and a recording of a whole device",
                             "recordings of one kind in one fit");
    }
    watch.lap("reading");
    if (!isComponentTest(recordings.front()) && !asks_for_element) {
        checkFitStart(answer.start, request.runs.model.file);
        checkSampleRate(recordings, answer.start);
        checkDisplacements(recordings, answer.start);
        for (Recording& recording : recordings) {
            checkWhole(recording, answer.start);
            if (!answer.start.sensors.empty()) recording = correctChannels(recording, answer.start.sensors);
        }
        watch.lap("checks");
        DeviceRuns device = estimateRuns(request, answer.start, recordings, watcher);
        watch.lap("kinematics");
        fitDevice(request, recordings, std::move(device), watcher, answer);
        return answer;
    }
    answer.timing.clear();
    request.component.time_known = !map || map->has_time || map->sample_interval != 1;
    fitElement(request, std::move(recordings), map ? &*map : nullptr, answer);
    return answer;
}

nlohmann::json toJson(const FitAnswer& answer) {
    nlohmann::json result =
        answer.mount ? makeFitJson(*answer.mount, answer.notes, answer.timing) : toJson(*answer.element);
    if (answer.blocks) result["blocks"] = answer.blocks->makeJson();
    for (const ValidationError& run : answer.validation)
        result["validation"].push_back({{"run", run.file}, {"error", numberOrNull(run.error)}});
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const FitAnswer& answer, TextStyle style) {
    if (answer.element) {
        std::string text = formatText(*answer.element, style);
        for (const ValidationError& test : answer.validation)
            text += "validation: " + test.file + ": root relative squared error " + formatPercent(test.error) + "\n";
        return text;
    }
    const FitResult& fit = *answer.mount;
    std::string text = makeParameterTable(fit).format(style);
    const Table open = makeOpenTable(fit);
    if (!open.rows().empty()) text += "\n" + open.format(style);
    text += "\n" + describeResidual(fit) + "\n";
    for (std::size_t i = 0; i < answer.validation.size(); ++i) {
        const ValidationError& run = answer.validation[i];
        text += "validation: " + (i < answer.validation_names.size() ? answer.validation_names[i] : run.file) + ": " +
                (run.problem.empty()
                     ? "error " + formatNumber(100 * run.error, 3) + " % of the measured relative displacement"
                     : run.problem) +
                "\n";
    }
    for (const auto& note : answer.notes) text += "note: " + note + "\n";
    for (const auto& [step, seconds] : answer.timing) text += "time: " + step + " " + formatNumber(seconds, 3) + " s\n";
    return text;
}

void writeReport(const FitAnswer& answer, const std::string& file, OutputFiles& outputs) {
    if (answer.element) return writeElementReport(answer, file, outputs);
    writeFitReport({*answer.mount, answer.start, answer.runs, answer.recordings, answer.notes}, file, outputs);
}

}  // namespace wems::identify::commands
