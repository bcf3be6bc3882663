#include "identify/forward/sensitivity.hpp"

#include <utility>

#include "models/parameter_access.hpp"

namespace wems::identify {
namespace {

Eigen::MatrixXd simulateWith(const MountModel& model, const std::string& name, double value, const Drive& drive,
                             const ShootingWindow& window) {
    MountModel changed = model;
    setParameter(changed, name, value);
    const ForwardModel forward(std::move(changed));
    return forward
        .simulate(drive, window.initial ? *window.initial : forward.restState(drive), window.first_sample,
                  window.sample_count)
        .q;
}

}  // namespace

ShootingWindow makeWholeRun(const Drive& drive) {
    return {0, drive.grid().samples, {}};
}

Eigen::MatrixXd calcJacobian(const MountModel& model, const Drive& drive, const ShootingWindow& window,
                             const std::vector<std::string>& names, double fraction) {
    Eigen::MatrixXd jacobian(3 * static_cast<Eigen::Index>(model.connections.size()) * window.sample_count,
                             static_cast<Eigen::Index>(names.size()));
    for (std::size_t j = 0; j < names.size(); ++j) {
        const double value = getParameter(model, names[j]);
        const double step = fraction * parameterScale(model, names[j]);
        const Eigen::MatrixXd difference = simulateWith(model, names[j], value + step, drive, window) -
                                           simulateWith(model, names[j], value - step, drive, window);
        jacobian.col(static_cast<Eigen::Index>(j)) = difference.reshaped() / (2 * step);
    }
    return jacobian;
}

double calcAmplification(const MountModel& model, const Drive& drive, const std::string& name, double fraction) {
    const ShootingWindow whole = makeWholeRun(drive);
    const double value = getParameter(model, name);
    const Eigen::MatrixXd base = simulateWith(model, name, value, drive, whole);
    const double step = fraction * parameterScale(model, name);
    const Eigen::MatrixXd moved = simulateWith(model, name, value + step, drive, whole);
    return (moved - base).norm() / base.norm() / fraction;
}

}  // namespace wems::identify
