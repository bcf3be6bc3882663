#include "identify/exact/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "identify/exact/cause_reports.hpp"
#include "identify/exact/expectation.hpp"
#include "identify/exact/leftover.hpp"
#include "identify/exact/pass.hpp"

namespace wems::identify {
namespace {

constexpr double kFloors = 1.5;       // the verdict's limits: noise floors …
constexpr double kLeastError = 0.03;  // … and error
constexpr double kNamed = 0.5;
constexpr double kAloneInAxis = 0.9;   // share of the base model's residual of the axis that is the place of all
constexpr double kCloserGain = 0.001;  // of the misfit per value, once the simulation says that something is missing
constexpr double kCloserShare = 0.5;   // of the simulated error above the noise that may be left then
constexpr double kBiasDoubt = 0.3;     // standard deviation of a bias that was measured, relative
constexpr int kBiasPasses = 2;
constexpr double kMoreExcess = 1.1;  // of the simulated error above the noise that its removal may bring
// Of the error of the simulation: a cause without which it grows by less is of no use to who reads it. Exact models on
// a shaken table were "explained" by inertias that changed it by 0.05 %.
constexpr double kWorth = 0.05;
constexpr int kPatches = 2;  // accepted laws at one axis that may be no explanation; more are none
// Misfit per value, above that of a perfect model, of a model that is right but cannot be predicted freely: with
// causes, whose values are known to some accuracy only, without, with laws at one axis that may describe its force
// together, and in terms of what is expected.
constexpr double kMisfitOfCauses = 0.5, kMisfitOfNothing = 0.15, kMisfitOfPatches = 0.05, kFolds = 3;
constexpr double kAnyMisfit = std::numeric_limits<double>::infinity();

bool isLarge(double error, double noise_floor) {
    return error > kFloors * noise_floor && error > kLeastError;
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
            result_.error_before = {calcFreeError(RunGroup(identification, model_).free_runs, model_).error,
                                    calcFreeError(RunGroup(judges, model_).free_runs, model_).error};
        measureAfter();
        if (pass_.selection.validation_after <= 1 + kMisfitOfCauses && leavesMuch()) lookCloser();
        const bool unexplained = isUnexplained() || isPatchwork();
        const bool one_place = unexplained && leaveOnePlace();
        if (unexplained && !pass_.selection.accepted.empty() &&
            result_.error_after.validation > corrected_before_.validation)
            dropCauses();
        if (!unexplained) {
            dropWorthless();
            removeBias();
        }
        std::vector<Judgement> without;
        for (std::size_t i = 0; i < pass_.selection.models_without.size(); ++i)
            without.push_back(judge(calcFreeError(pass_.judge_group.free_runs, pass_.selection.models_without[i]).error,
                                    pass_.selection.without[i]));
        const Judgement after = judge(result_.error_after.validation, pass_.selection.validation_after);
        result_.causes = makeCauseReports(pass_.selection, without, after, unexplained);
        if (unexplained && !one_place) locateLeftover();
        if (one_place)
            for (auto& cause : result_.causes) cause.probability = std::min(cause.probability, kDoubtful);
        for (std::size_t i = 0; i < faults.size(); ++i) {
            const RunGroup with_fault(correctFaults(judges, faults, i), model_);
            addSensorCause(faults[i], calcFreeError(with_fault.free_runs, result_.extended).error / after.error,
                           unexplained, result_.causes);
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

    bool leavesMuch() const { return isLarge(result_.error_after.validation, result_.noise_floor.validation); }

    /// True if the equations of some runs are left with more than a perfect model would leave: of the misfit per value,
    /// what exceeds 1 is below `least` without saying anything, above `most` it is not asked what is expected.
    bool exceedsExpected(const RunGroup& group, double misfit, double least, double most) const {
        if (misfit <= 1 + least) return false;
        if (misfit > 1 + most) return true;
        return misfit > 1 + kFolds * (calcExpectation(group.motions, model_, result_.extended).misfit - 1);
    }

    /// Without a cause that was fitted to them the identification runs tell as much as those that judge. Causes that
    /// the simulation does not gain from count as none.
    bool isUnexplained() const {
        if (!leavesMuch()) return false;
        const Selection& selection = pass_.selection;
        // A misfit that is no number satisfies nothing.
        if (!std::isfinite(selection.validation_after) || !std::isfinite(selection.identification_after)) return true;
        if (!selection.accepted.empty() && result_.error_after.validation <= corrected_before_.validation)
            return exceedsExpected(pass_.judge_group, selection.validation_after, kMisfitOfCauses, kAnyMisfit);
        return exceedsExpected(pass_.judge_group, selection.validation_after, kMisfitOfNothing, kMisfitOfCauses) ||
               exceedsExpected(pass_.fit_group, selection.identification_after, kMisfitOfNothing, kMisfitOfCauses);
    }

    /// Whole sides of sensors, which the equations know to first order.
    bool namesSensors() const {
        const auto& accepted = pass_.selection.accepted;
        return std::any_of(accepted.begin(), accepted.end(),
                           [](const Candidate& candidate) { return candidate.cause.rfind("sensor_", 0) == 0; });
    }

    /// Takes from the values what the method makes of simulated recordings whose values are known, unless the free
    /// simulation loses by it. A bias beyond the standard error is measured once more where the values are then.
    void removeBias() {
        auto& selection = pass_.selection;
        if (selection.accepted.empty() || namesSensors()) return;
        const auto knobs = collectKnobs(selection.accepted);
        const auto isWithinErrors = [&](const Eigen::VectorXd& bias) {
            for (std::size_t i = 0; i < knobs.size(); ++i)
                if (std::abs(bias[i]) > selection.standard_errors[i]) return false;
            return true;
        };
        const ParameterFit biased = selection.fit;
        const double excess = calcExcess(result_.error_after.validation);
        Eigen::VectorXd bias;
        for (int pass = 0; pass < kBiasPasses && (pass == 0 || !isWithinErrors(bias)); ++pass) {
            bias = calcFitBias(pass_.fit_group.motions, model_, selection.fit.model, knobs);
            for (std::size_t i = 0; i < knobs.size(); ++i) {
                auto& value = selection.fit.values[i];
                value = std::clamp(biased.values[i] - bias[i], knobs[i].lowest(biased.model),
                                   knobs[i].highest(biased.model));
                knobs[i].set(selection.fit.model, value);
            }
        }
        measureAfter();
        if (calcExcess(result_.error_after.validation) > kMoreExcess * excess) {
            selection.fit = biased;
            measureAfter();
        }
        for (std::size_t i = 0; i < knobs.size(); ++i)
            selection.standard_errors[i] = std::hypot(selection.standard_errors[i], kBiasDoubt * bias[i]);
    }

    Judgement judge(double error, double misfit) const {
        if (simulation_judged_) misfit = std::pow(error / result_.noise_floor.validation, 2);
        return {error, misfit};
    }

    /// Of an error of the validation runs, what their noise does not make.
    double calcExcess(double error) const {
        return std::sqrt(std::max(0.0, std::pow(error, 2) - std::pow(result_.noise_floor.validation, 2)));
    }

    /// What acts in short contacts only, as a stop's dissipation, or in no run but in what the model makes of it, is
    /// little in equations over all samples of the measured motion, but not in the simulation. Smaller gains count
    /// then, if the simulation agrees.
    void lookCloser() {
        Selection first = std::move(pass_.selection);
        const double most = kCloserShare * calcExcess(result_.error_after.validation);
        SelectionOptions options;
        options.least_gain = kCloserGain;
        options.judged_elsewhere = true;
        options.max_rounds = static_cast<int>(first.accepted.size()) + 1;
        const auto weigh = [&](const MountModel& start) {
            pass_.fit_problem.rewhiten(start);
            pass_.judge_problem.rewhiten(start);
            pass_.fit_problem.setReference(start);
            pass_.judge_problem.setReference(start);
        };
        weigh(model_);
        pass_.selection = selectCauses(pass_.fit_problem, pass_.judge_problem, model_, options);
        measureAfter();
        if (pass_.selection.accepted.size() > first.accepted.size() && !namesSensors() &&
            calcExcess(result_.error_after.validation) < most) {
            auto& rounds = pass_.selection.rounds;
            rounds.insert(rounds.begin(), first.rounds.begin(), first.rounds.end());
            dropRivals(most);
            simulation_judged_ = true;
            chosen_by_ = options;
            return;
        }
        pass_.selection = std::move(first);
        weigh(pass_.selection.fit.model);
        measureAfter();
    }

    /// Rivals whose simulation leaves more than that above the noise are none.
    void dropRivals(double most) {
        auto& selection = pass_.selection;
        for (std::size_t i = 0; i < selection.rivals.size(); ++i) {
            auto& rivals = selection.rivals[i];
            const auto fails = [&](const Trial& rival) {
                MountModel model = selection.models_without[i];
                rival.candidate.apply(model, rival.values);
                return calcExcess(calcFreeError(pass_.judge_group.free_runs, model).error) > most;
            };
            rivals.erase(std::remove_if(rivals.begin(), rivals.end(), fails), rivals.end());
        }
    }

    /// Three laws of the catalogue at one axis describe a law that is not in it; so do two that leave more than a
    /// perfect model would.
    bool isPatchwork() const {
        std::map<std::string, int> laws;
        int most = 0;
        for (const Candidate& candidate : pass_.selection.accepted) {
            if (candidate.where.size() != 1) continue;
            const std::string& where = candidate.where.front();  // 4.z or 4.z.+
            const auto axis = where.find('.');
            if (axis != std::string::npos) most = std::max(most, ++laws[where.substr(0, axis + 2)]);
        }
        if (most < kPatches) return false;
        if (most > kPatches) return true;
        return exceedsExpected(pass_.fit_group, pass_.selection.identification_after, kMisfitOfPatches, kAnyMisfit);
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
            reselect(options);
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

    /// What the equations gain from a cause, noise in their regressors can give: the one that neither group's
    /// simulation needs is taken out of the catalogue, and the causes are sought again.
    void dropWorthless() {
        SelectionOptions options = chosen_by_;
        while (!pass_.selection.accepted.empty()) {
            const auto& selection = pass_.selection;
            double least = 1 + kWorth;
            const Candidate* idle = nullptr;
            for (std::size_t i = 0; i < selection.accepted.size(); ++i) {
                if (selection.accepted[i].cause.rfind("sensor_", 0) == 0) continue;
                const double growth = calcGrowth(selection.models_without[i]);
                if (growth >= least) continue;
                least = growth;
                idle = &selection.accepted[i];
            }
            if (idle == nullptr) return;
            options.excluded.push_back(*idle);
            reselect(options);
        }
    }

    /// The error of the simulation with another model over the present one, of the group that it grows more in.
    double calcGrowth(const MountModel& model) const {
        return std::max(calcFreeError(pass_.fit_group.free_runs, model).error / result_.error_after.identification,
                        calcFreeError(pass_.judge_group.free_runs, model).error / result_.error_after.validation);
    }

    /// Seeks the causes again, from the believed model on; the record of rounds goes on.
    void reselect(const SelectionOptions& options) {
        const auto rounds = std::move(pass_.selection.rounds);
        pass_.fit_problem.rewhiten(model_);
        pass_.judge_problem.rewhiten(model_);
        pass_.selection = selectCauses(pass_.fit_problem, pass_.judge_problem, model_, options);
        pass_.selection.rounds.insert(pass_.selection.rounds.begin(), rounds.begin(), rounds.end());
        measureAfter();
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
    Expectation expected_;            // of the validation runs, where they leave more than noise
    SelectionOptions chosen_by_;      // of the present causes
    bool simulation_judged_ = false;  // rather than the equations of motion
};

}  // namespace

void judgeBySimulation(Pass& pass, const MountModel& model, const std::vector<Recording>& identification,
                       const std::vector<Recording>& judges, const std::vector<ChannelFault>& faults,
                       const std::vector<ChannelFault>& on_accelerations, Diagnosis& result) {
    Judge(pass, model, result).run(identification, judges, faults, on_accelerations);
}

}  // namespace wems::identify
