#include "identify/forward/simulation_error.hpp"

#include "identify/forward/forward_model.hpp"

namespace wems::identify {

PreparedRun prepareRun(const RunMotion& run, const MountModel& model, double lowest_frequency) {
    PreparedRun prepared{Drive::make(run, model, makeGrid(run, model)), calcRelativeDisplacement(run, model), {}};
    prepared.start = findStartMotion(run, model, prepared.drive);
    prepared.measured.lowest_frequency = lowest_frequency;
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
    simulated.q =
        forward.simulate(run.drive, initial, 0, run.drive.grid().samples).q.colwise() - forward.restDisplacement();
    simulated.lowest_frequency = run.measured.lowest_frequency;
    if (run.measured.from_accelerations) removeSlowMotion(simulated, simulated.lowest_frequency);
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
