#include "identify/forward/simulation_error.hpp"

#include "identify/forward/forward_model.hpp"
#include "identify/motion/spectrum.hpp"

namespace wems::identify {
namespace {

// Steps for each that the forward model takes for speed. Base sweeps deep into the stops, whose motion amplifies errors
// up to 400 times: 2e-3 to 1.4e-1 of the displacement became 2e-5 to 1e-3.
constexpr int finer = 3;

TimeGrid makeFineGrid(const RunMotion& run, const MountModel& model) {
    TimeGrid grid = makeGrid(run, model);
    grid.steps_per_sample *= finer;
    return grid;
}

/// Adds what integrating the accelerations at the samples gives beside the displacement itself.
void addFolded(RelativeDisplacement& simulated, const MarkerMotion& markers, bool fixed_too) {
    // Below what comparisons leave, so that the high pass of the integration is not seen.
    const double lowest = 0.6 * simulated.lowest_frequency;
    for (Eigen::Index i = 0; i < simulated.q.rows(); ++i) {
        Eigen::VectorXd acceleration = markers.mobile_acceleration.row(i);
        Eigen::VectorXd displacement = markers.mobile_displacement.row(i);
        if (fixed_too) {
            acceleration -= markers.fixed_acceleration.row(i).transpose();
            displacement -= markers.fixed_displacement.row(i).transpose();
        }
        simulated.q.row(i) += integrateTwice(acceleration, simulated.interval(), lowest).x - displacement;
    }
}

}  // namespace

PreparedRun prepareRun(const RunMotion& run, const MountModel& model, double lowest_frequency) {
    PreparedRun prepared{
        Drive::make(run, model, makeFineGrid(run, model)), calcRelativeDisplacement(run, model), {}, false};
    prepared.start = findStartMotion(run, model, prepared.drive);
    prepared.measured.lowest_frequency = lowest_frequency;
    prepared.fixed_integrated = run.fixed_trusted_from > 0;
    if (prepared.measured.from_accelerations) removeSlowMotion(prepared.measured, lowest_frequency);
    return prepared;
}

RelativeDisplacement simulateRun(const MountModel& model, const PreparedRun& run) {
    const ForwardModel forward(model);
    RelativeDisplacement simulated;
    simulated.file = run.measured.file;
    simulated.time = run.measured.time;
    simulated.names = run.measured.names;
    const ForwardState initial = makeInitialState(forward, run.start, run.drive);
    const bool integrated = run.measured.from_accelerations;
    const Simulation simulation = forward.simulate(run.drive, initial, 0, run.drive.grid().samples,
                                                   integrated ? Keep::states : Keep::displacement);
    simulated.q = simulation.q.colwise() - forward.restDisplacement();
    simulated.lowest_frequency = run.measured.lowest_frequency;
    if (integrated) {
        addFolded(simulated, forward.calcMarkers(simulation, run.drive), run.fixed_integrated);
        removeSlowMotion(simulated, simulated.lowest_frequency);
    }
    return simulated;
}

ErrorSum calcSimulationError(const MountModel& model, const PreparedRun& run) {
    const Eigen::MatrixXd q = simulateRun(model, run).q;
    ErrorSum sum;
    for (Eigen::Index k = 0; k < q.cols(); ++k)
        for (Eigen::Index i = 0; i < q.rows(); ++i) sum.add(q(i, k) - run.measured.q(i, k), run.measured.q(i, k));
    return sum;
}

}  // namespace wems::identify
