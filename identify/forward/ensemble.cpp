#include "identify/forward/ensemble.hpp"

#include <algorithm>
#include <stdexcept>

#include "identify/forward/lanes.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

/// Numbers that begin where the widest vectors may be read.
class AlignedNumbers {
public:
    explicit AlignedNumbers(std::size_t count) : storage_(count + alignment / sizeof(double)) {
        void* start = storage_.data();
        std::size_t space = storage_.size() * sizeof(double);
        begin_ = static_cast<double*>(std::align(alignment, count * sizeof(double), start, space));
    }
    double* data() { return begin_; }

private:
    static constexpr std::size_t alignment = 64;  // bytes
    std::vector<double> storage_;
    double* begin_;
};

/// One set on its way through a lane.
struct Passenger {
    const ForwardModel* model = nullptr;
    Eigen::VectorXd initial;
    Eigen::Matrix3Xd gains;
    Eigen::MatrixXd q;
};

void runTogether(const LaneProgram& program, std::vector<Passenger>& passengers, const Drive& drive, int first_sample,
                 int sample_count) {
    const std::size_t lanes = program.lanes;
    const KernelModel& kernel = passengers.front().model->kernel();
    const std::size_t count = kernel.constants().size();
    AlignedNumbers constants(count * lanes);
    std::vector<LaneRun> runs(lanes);
    Eigen::MatrixXd unused = passengers.front().q;
    for (std::size_t l = 0; l < lanes; ++l) {
        // Lanes without a set repeat the first one.
        const bool used = l < passengers.size();
        Passenger& passenger = passengers[used ? l : 0];
        const std::vector<double>& own = passenger.model->kernel().constants();
        for (std::size_t i = 0; i < count; ++i) constants.data()[i * lanes + l] = own[i];
        runs[l].initial = passenger.initial.data();
        if (passenger.gains.size() > 0) runs[l].gain = passenger.gains.data();
        runs[l].q = used ? passenger.q.data() : unused.data();
    }
    const StepPlan plan = kernel.makePlan(drive, first_sample, sample_count);
    const MountKernel<double> structure = kernel.makeKernel<double>(nullptr, drive.prescribesMotion());
    AlignedNumbers work(static_cast<std::size_t>(plan.workSize(structure.connections)) * lanes);
    program.run(structure, plan, constants.data(), runs.data(), work.data());
    for (std::size_t l = 0; l < passengers.size(); ++l)
        if (runs[l].diverged_at >= 0) passengers[l].q.resize(0, 0);
}

}  // namespace

LaneProgram chooseLaneProgram() {
#ifdef WEMS_WIDE_LANES
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return {8, runEightLanes};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {4, runFourLanes};
#endif
    return {2, runTwoLanes};
}

ForwardEnsemble::ForwardEnsemble(const std::vector<MountModel>& models) {
    for (std::size_t i = 0; i < models.size(); ++i) {
        members_.push_back(std::make_unique<ForwardModel>(models[i]));
        const auto group = std::find_if(groups_.begin(), groups_.end(), [&](const std::vector<std::size_t>& indices) {
            return members_[indices.front()]->kernel().sameStructure(members_[i]->kernel());
        });
        if (group == groups_.end() || members_[i]->holdsMotions()) {
            groups_.push_back({i});
        } else {
            group->push_back(i);
        }
    }
}

std::vector<Eigen::MatrixXd> ForwardEnsemble::simulate(const Drive& drive) const {
    std::vector<ForwardState> initial;
    initial.reserve(size());
    for (const auto& member : members_) initial.push_back(member->restState(drive));
    return simulate(drive, initial, 0, drive.grid().samples);
}

std::vector<Eigen::MatrixXd> ForwardEnsemble::simulate(const Drive& drive, const std::vector<ForwardState>& initial,
                                                       int first_sample, int sample_count) const {
    if (initial.size() != size()) throw std::invalid_argument("ForwardEnsemble: one state for each set is needed");
    if (first_sample < 0 || sample_count < 1 || first_sample + sample_count > drive.grid().samples)
        throw std::invalid_argument("ForwardEnsemble::simulate: samples outside the drive's grid");
    const LaneProgram program = chooseLaneProgram();
    std::vector<Eigen::MatrixXd> result(size());
    for (const std::vector<std::size_t>& group : groups_) {
        if (group.size() == 1) {
            const std::size_t index = group.front();
            try {
                result[index] = members_[index]->simulate(drive, initial[index], first_sample, sample_count).q;
            } catch (const SimulationDiverged&) {
                result[index].resize(0, 0);
            }
            continue;
        }
        for (std::size_t from = 0; from < group.size(); from += static_cast<std::size_t>(program.lanes)) {
            const std::size_t to = std::min(group.size(), from + static_cast<std::size_t>(program.lanes));
            std::vector<Passenger> passengers(to - from);
            for (std::size_t i = from; i < to; ++i) {
                const ForwardModel& model = *members_[group[i]];
                passengers[i - from] = {&model, model.packState(initial[group[i]], drive), model.calcGains(drive),
                                        Eigen::MatrixXd(model.restDisplacement().size(), sample_count)};
            }
            runTogether(program, passengers, drive, first_sample, sample_count);
            for (std::size_t i = from; i < to; ++i) result[group[i]] = std::move(passengers[i - from].q);
        }
    }
    return result;
}

namespace {

// Parameters whose runs are kept at a time.
constexpr std::size_t parameters_at_once = 16;

/// The model with a parameter moved down and up.
void addMoved(std::vector<MountModel>& models, const MountModel& model, const std::string& name, double step) {
    const double value = getParameter(model, name);
    for (const double moved : {value - step, value + step}) setParameter(models.emplace_back(model), name, moved);
}

std::vector<Eigen::MatrixXd> simulateAll(const std::vector<MountModel>& models, const Drive& drive,
                                         const ShootingWindow& window) {
    const ForwardEnsemble ensemble(models);
    std::vector<ForwardState> initial;
    for (std::size_t i = 0; i < ensemble.size(); ++i)
        initial.push_back(window.initial ? *window.initial : ensemble.member(i).restState(drive));
    std::vector<Eigen::MatrixXd> q = ensemble.simulate(drive, initial, window.first_sample, window.sample_count);
    for (const Eigen::MatrixXd& run : q)
        if (run.size() == 0) throw SimulationDiverged(drive.grid().sampleTime(window.first_sample));
    return q;
}

}  // namespace

ShootingWindow makeWholeRun(const Drive& drive) {
    return {0, drive.grid().samples, {}};
}

Eigen::MatrixXd calcJacobian(const MountModel& model, const Drive& drive, const ShootingWindow& window,
                             const std::vector<std::string>& names, double fraction) {
    Eigen::MatrixXd jacobian(3 * static_cast<Eigen::Index>(model.connections.size()) * window.sample_count,
                             names.size());
    for (std::size_t from = 0; from < names.size(); from += parameters_at_once) {
        const std::size_t to = std::min(names.size(), from + parameters_at_once);
        std::vector<MountModel> models;
        for (std::size_t j = from; j < to; ++j)
            addMoved(models, model, names[j], fraction * parameterScale(model, names[j]));
        const std::vector<Eigen::MatrixXd> q = simulateAll(models, drive, window);
        for (std::size_t j = from; j < to; ++j) {
            const std::size_t down = 2 * (j - from);
            jacobian.col(j) = (q[down + 1] - q[down]).reshaped() / (2 * fraction * parameterScale(model, names[j]));
        }
    }
    return jacobian;
}

double calcAmplification(const MountModel& model, const Drive& drive, const std::string& name, double fraction) {
    std::vector<MountModel> models{model, model};
    setParameter(models[1], name, getParameter(model, name) + fraction * parameterScale(model, name));
    const std::vector<Eigen::MatrixXd> q = simulateAll(models, drive, makeWholeRun(drive));
    return (q[1] - q[0]).norm() / q[0].norm() / fraction;
}

}  // namespace wems::identify
