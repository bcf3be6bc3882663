#include "identify/forward/sensitivity.hpp"

#include <algorithm>

#include "identify/forward/ensemble.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {
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
