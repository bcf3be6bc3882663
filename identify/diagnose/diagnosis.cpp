#include "identify/diagnose/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "identify/diagnose/acceleration_faults.hpp"
#include "identify/diagnose/cause_report.hpp"
#include "identify/diagnose/channel_correction.hpp"
#include "identify/diagnose/channel_faults.hpp"
#include "identify/diagnose/free_error.hpp"
#include "identify/diagnose/leftover.hpp"
#include "identify/diagnose/slow_motion.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/error.hpp"

namespace wems::identify {
namespace {

constexpr double kGainScatter = 1e-3;  // ordinary calibration of a channel
constexpr double kFloors = 1.5;        // the verdict's limits: noise floors …
constexpr double kLeastError = 0.03;   // … and error
constexpr int kPasses = 3;
constexpr double kNamed = 0.5;
constexpr double kAloneInAxis = 0.9;     // share of the base model's residual of the axis that is the place of all
constexpr int kPatches = 3;              // accepted laws at one axis that are no explanation
constexpr double kOpenLoopEnough = 1.5;  // misfit per value of a model that is right but cannot be predicted freely

/// Accelerations next to complete displacements serve the consistency of channels; the equations take one kind, so
/// that no weighting between two kinds can colour their residual.
Recording withoutAccelerations(const Recording& recording, const MountModel& model) {
    const auto has = [&](const char* side) {
        for (const auto& connection : model.connections)
            for (const char* axis : {"x", "y", "z"})
                if (recording.find(side + connection.name + "." + axis) == nullptr) return false;
        return true;
    };
    if (!has("mobile.") || !has("fixed.")) return recording;
    Recording result = recording;
    result.channels.clear();
    for (const auto& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (name && (name->part == Part::mobile || name->part == Part::fixed) &&
            name->derivative != Derivative::displacement)
            continue;
        result.channels.push_back(channel);
    }
    return result;
}

/// Runs of one group with all that the steps need.
struct Group {
    std::vector<RunMotion> motions;
    std::vector<FreeRun> free_runs;
    std::vector<Eigen::VectorXd> swept;

    Group(const std::vector<Recording>& recordings, const MountModel& model) {
        for (const auto& recording : recordings) {
            const Recording used = withoutAccelerations(recording, model);
            motions.push_back(estimateMotion(used, model));
            restoreSlowMotion(motions.back(), model);
            swept.push_back(findSweptFrequency(used).hertz);
            free_runs.push_back({nullptr, calcMeasuredRelative(used, motions.back(), model)});
        }
        for (std::size_t i = 0; i < motions.size(); ++i) free_runs[i].motion = &motions[i];
    }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;
    OpenLoopProblem makeProblem(const MountModel& model) const {
        std::vector<OpenLoopRun> runs;
        for (std::size_t i = 0; i < motions.size(); ++i) runs.push_back(makeOpenLoopRun(motions[i], model, swept[i]));
        return {std::move(runs), model, kGainScatter};
    }
};

/// Recordings without the faults, but for the one with index `kept` (none if there is no such).
std::vector<Recording> correct(const std::vector<Recording>& recordings, const std::vector<ChannelFault>& faults,
                               std::size_t kept) {
    std::vector<SensorFault> list;
    for (std::size_t i = 0; i < faults.size(); ++i)
        if (i != kept) list.push_back(faults[i].fault);
    std::vector<Recording> result;
    result.reserve(recordings.size());
    for (const auto& recording : recordings) result.push_back(correctChannels(recording, list));
    return result;
}

bool isLarge(double error, double noise_floor) {
    return error > kFloors * noise_floor && error > kLeastError;
}

/// One pass: motions, equations and selection with the given faults corrected.
struct Pass {
    Group fit_group, judge_group;
    OpenLoopProblem fit_problem, judge_problem;
    Selection selection;

    Pass(const std::vector<Recording>& identification, const std::vector<Recording>& judges,
         const std::vector<ChannelFault>& faults, const MountModel& model, const SelectionOptions& options)
        : fit_group(correct(identification, faults, faults.size()), model),
          judge_group(correct(judges, faults, faults.size()), model),
          fit_problem(fit_group.makeProblem(model)),
          judge_problem(judge_group.makeProblem(model)),
          selection(selectCauses(fit_problem, judge_problem, model, options)) {}
};

/// Moves the faults of whole sides, which a pass knows to first order only, to the list that is corrected exactly.
bool moveSideFaults(const Selection& selection, std::vector<ChannelFault>& faults) {
    bool moved = false;
    Eigen::Index first = 0;
    for (const auto& candidate : selection.accepted) {
        const Eigen::Index own = first;
        first += static_cast<Eigen::Index>(candidate.knobs.size());
        if (candidate.cause.rfind("sensor_", 0) != 0) continue;
        moved = true;
        const std::string& side = candidate.where.front();
        auto known = std::find_if(faults.begin(), faults.end(), [&](const ChannelFault& fault) {
            return fault.cause == candidate.cause && fault.fault.channel == side;
        });
        if (known == faults.end()) {
            ChannelFault fault;
            fault.cause = candidate.cause;
            fault.fault.channel = side;
            known = faults.insert(faults.end(), fault);
        }
        const double error = std::sqrt(std::max(0.0, selection.fit.covariance(own, own)));
        for (const auto& sensor : selection.fit.model.sensors) {
            if (sensor.channel != side) continue;
            if (candidate.cause == "sensor_gain") {
                known->fault.gain *= sensor.gain;
                known->gain_error = error;
            } else if (candidate.cause == "sensor_delay") {
                known->fault.delay += sensor.delay;
                known->delay_error = error;
            } else {
                known->fault.rotation += sensor.rotation;
                known->rotation_error = error;
            }
        }
    }
    return moved;
}

/// A triax of accelerometers (`mobile.1.a`) becomes its three channels.
void addSensor(const SensorFault& fault, MountModel& model) {
    const auto size = fault.channel.size();
    if (size < 2 || fault.channel.compare(size - 2, 2, ".a") != 0) {
        model.sensors.push_back(fault);
        return;
    }
    for (const char* axis : {"x", "y", "z"}) {
        model.sensors.push_back(fault);
        model.sensors.back().channel += axis;
    }
}

/// Errors of free simulations before and after, with and without each cause, and what follows from them.
class Judge {
public:
    Judge(Pass& pass, const MountModel& model, Diagnosis& result) : pass_(pass), model_(model), result_(result) {}

    void run(const std::vector<Recording>& identification, const std::vector<Recording>& judges,
             std::vector<ChannelFault> faults, const std::vector<ChannelFault>& on_accelerations) {
        const auto before = calcFreeError(pass_.fit_group.free_runs, model_),
                   judged_before = calcFreeError(pass_.judge_group.free_runs, model_);
        corrected_before_ = {before.error, judged_before.error};
        result_.error_before = corrected_before_;
        result_.noise_floor = {before.noise_floor, judged_before.noise_floor};
        if (!faults.empty())
            result_.error_before = {calcFreeError(Group(identification, model_).free_runs, model_).error,
                                    calcFreeError(Group(judges, model_).free_runs, model_).error};
        measureAfter();
        const bool unexplained = isUnexplained() || isPatchwork();
        const bool one_place = unexplained && leaveOnePlace();
        if (unexplained && !pass_.selection.accepted.empty() &&
            result_.error_after.validation > corrected_before_.validation)
            dropCauses();
        const double after = result_.error_after.validation;
        std::vector<double> errors_without;
        for (const auto& without : pass_.selection.models_without)
            errors_without.push_back(calcFreeError(pass_.judge_group.free_runs, without).error);
        result_.causes = makeCauseReports(pass_.selection, errors_without, after, unexplained);
        if (unexplained && !one_place) locateLeftover();
        if (one_place)
            for (auto& cause : result_.causes) cause.probability = std::min(cause.probability, kDoubtful);
        for (std::size_t i = 0; i < faults.size(); ++i) {
            const Group with_fault(correct(judges, faults, i), model_);
            addSensorCause(faults[i], calcFreeError(with_fault.free_runs, result_.extended).error / after, unexplained,
                           result_.causes);
        }
        for (const auto& fault : on_accelerations) addSensorCause(fault, 1.0, unexplained, result_.causes);
        faults.insert(faults.end(), on_accelerations.begin(), on_accelerations.end());
        for (const auto& fault : faults) addSensor(fault.fault, result_.extended);
        result_.verdict = unexplained              ? Diagnosis::Verdict::unexplained
                          : result_.causes.empty() ? Diagnosis::Verdict::nothing_missing
                                                   : Diagnosis::Verdict::explained;
    }

private:
    void measureAfter() {
        result_.extended = pass_.selection.fit.model;
        result_.error_after = corrected_before_;
        if (!pass_.selection.accepted.empty())
            result_.error_after = {calcFreeError(pass_.fit_group.free_runs, result_.extended).error,
                                   calcFreeError(pass_.judge_group.free_runs, result_.extended).error};
    }

    bool isUnexplained() const {
        return isLarge(result_.error_after.validation, result_.noise_floor.validation) &&
               pass_.selection.validation_after > kOpenLoopEnough;
    }

    /// Three laws of the catalogue at one axis describe a law that is not in it.
    bool isPatchwork() const {
        std::map<std::string, int> laws;
        for (const Candidate& candidate : pass_.selection.accepted) {
            if (candidate.where.size() != 1) continue;
            const std::string& where = candidate.where.front();  // 4.z or 4.z.+
            const auto axis = where.find('.');
            if (axis != std::string::npos && ++laws[where.substr(0, axis + 2)] == kPatches) return true;
        }
        return false;
    }

    /// If a force along one axis could make nearly all that the model without any extension leaves, that axis is the
    /// place, and causes that were accepted elsewhere only made up for it. True if so.
    bool leaveOnePlace() {
        pass_.fit_problem.setReference(model_);
        const auto residual = pass_.fit_problem.calcResidual(model_);
        const auto place = calcPlaceShares(pass_.fit_problem, model_, residual).front();
        if (place.share < kAloneInAxis) return false;
        const auto elsewhere = [&](const Candidate& candidate) {
            return std::any_of(candidate.where.begin(), candidate.where.end(),
                               [&](const std::string& where) { return where.rfind(place.name, 0) != 0; });
        };
        auto& accepted = pass_.selection.accepted;
        if (std::any_of(accepted.begin(), accepted.end(), elsewhere)) {
            SelectionOptions options;
            options.only_place = place.name;
            const auto rounds = std::move(pass_.selection.rounds);
            pass_.fit_problem.rewhiten(model_);
            pass_.judge_problem.rewhiten(model_);
            pass_.selection = selectCauses(pass_.fit_problem, pass_.judge_problem, model_, options);
            pass_.selection.rounds.insert(pass_.selection.rounds.begin(), rounds.begin(), rounds.end());
            measureAfter();
        }
        result_.unexplained_where = {place.name};
        for (const auto& regime : findRegimes(pass_.fit_problem, result_.extended))
            result_.unexplained_where.push_back(regime);
        return true;
    }

    /// Where no axis alone carries all: seen from the model with what is named, without what is not.
    void locateLeftover() {
        const bool named = std::any_of(result_.causes.begin(), result_.causes.end(),
                                       [](const Cause& cause) { return cause.probability >= kNamed; });
        const MountModel& seen = named ? pass_.selection.fit.model : model_;
        result_.unexplained_where = locateResidual(pass_.fit_problem, seen, pass_.fit_problem.calcResidual(seen));
    }

    /// What makes the simulation worse is no extension.
    void dropCauses() {
        auto& selection = pass_.selection;
        selection.accepted.clear();
        selection.models_without.clear();
        selection.without.clear();
        selection.rivals.clear();
        selection.fit.model = model_;
        selection.validation_after = selection.validation_before;
        selection.identification_after = selection.identification_before;
        measureAfter();
    }

    Pass& pass_;
    const MountModel& model_;
    Diagnosis& result_;
    GroupError corrected_before_;
};

}  // namespace

Diagnosis diagnose(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                   const MountModel& model, const DiagnosisOptions& options) {
    if (identification.empty()) throw InputError({}, "no recording to diagnose", "at least one CSV file");
    const auto tell = [&](const std::string& text) {
        if (options.progress) options.progress(text);
    };
    Diagnosis result;
    result.validated = !validation.empty();
    const auto& judges = result.validated ? validation : identification;
    tell("consistency of the channels");
    std::vector<Recording> all = identification;
    all.insert(all.end(), validation.begin(), validation.end());
    auto faults = findChannelFaults(all, model, kGainScatter);
    SelectionOptions selection_options;
    selection_options.progress = options.progress;
    tell("equations of motion");
    auto pass = std::make_unique<Pass>(identification, judges, faults, model, selection_options);
    for (int number = 1; number < kPasses && moveSideFaults(pass->selection, faults); ++number) {
        tell("equations of motion with corrected channels");
        pass = std::make_unique<Pass>(identification, judges, faults, model, selection_options);
    }
    for (const auto& motion : pass->fit_group.motions)
        for (const auto& note : motion.notes)
            if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
                result.notes.push_back(note);
    const auto on_accelerations = findAccelerationFaults(correct(identification, faults, faults.size()),
                                                         pass->fit_group.motions, model, kGainScatter);
    tell("free simulations");
    Judge(*pass, model, result).run(identification, judges, faults, on_accelerations);
    pass->judge_problem.setReference(model);
    result.spectrum.before = calcMisfitByFrequency(pass->judge_problem, pass->judge_problem.calcResidual(model));
    result.spectrum.after =
        calcMisfitByFrequency(pass->judge_problem, pass->judge_problem.calcResidual(pass->selection.fit.model));
    for (std::size_t i = 0; i < result.spectrum.before.size(); ++i)
        result.spectrum.frequency.push_back(static_cast<double>(i) + 0.5);
    result.misfit_before = pass->selection.validation_before;
    result.misfit_after = pass->selection.validation_after;
    result.rounds = pass->selection.rounds;
    return result;
}

std::string formatVerdict(Diagnosis::Verdict verdict) {
    switch (verdict) {
        case Diagnosis::Verdict::explained:
            return "explained";
        case Diagnosis::Verdict::nothing_missing:
            return "nothing_missing";
        case Diagnosis::Verdict::unexplained:
            return "unexplained";
    }
    return {};
}

}  // namespace wems::identify
