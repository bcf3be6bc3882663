// What a simulation with kept states can tell beyond relative displacements: markers and energy.
#include <Eigen/Geometry>
#include <stdexcept>

#include "identify/forward/forward_model.hpp"

namespace wems::identify {
namespace {

void requireStates(const Simulation& simulation) {
    if (simulation.states.cols() != simulation.q.cols())
        throw std::invalid_argument("ForwardModel: the simulation was run without keeping states");
}

/// Acceleration of a point at `arm` (G) from a frame's origin.
Eigen::Vector3d calcPointAcceleration(const Eigen::Vector3d& origin, const Eigen::Vector3d& angular,
                                      const Eigen::Vector3d& w, const Eigen::Vector3d& arm) {
    return origin + angular.cross(arm) + w.cross(w.cross(arm));
}

}  // namespace

ForwardState ForwardModel::stateAt(const Simulation& simulation, const Drive& drive, int column) const {
    requireStates(simulation);
    return unpack(simulation.states.col(column).data(), drive);
}

MarkerMotion ForwardModel::calcMarkers(const Simulation& simulation, const Drive& drive) const {
    requireStates(simulation);
    const auto rows = simulation.q.rows();
    const auto columns = simulation.q.cols();
    MarkerMotion markers;
    for (auto* matrix : {&markers.mobile_displacement, &markers.fixed_displacement, &markers.mobile_acceleration,
                         &markers.fixed_acceleration})
        matrix->resize(rows, columns);
    const FrameMotion rest_frame = modeCount() > 0 ? bracket_.calcMotion(rest_.eta, rest_.eta_dot) : FrameMotion();
    for (Eigen::Index k = 0; k < columns; ++k) {
        const double* y = simulation.states.col(k).data();
        const double* rates = simulation.rates.col(k).data();
        const int half = drive.grid().halfStepOf(simulation.first_sample + static_cast<int>(k));
        const BodyMotion body = calcBody(y);
        const FrameMotion frame = calcFrame(y, drive, half);
        const Bracket::FrameAcceleration fixed = calcFrameAcceleration(y, rates, drive, half);
        const Eigen::Vector3d base = drive.base().cols() > 0 ? Eigen::Vector3d(drive.base().col(half))
                                                             : Eigen::Vector3d(Eigen::Vector3d::Zero());
        const Eigen::Vector3d table = drive.baseDisplacement().cols() > 0
                                          ? Eigen::Vector3d(drive.baseDisplacement().col(half))
                                          : Eigen::Vector3d(Eigen::Vector3d::Zero());
        const Eigen::Vector3d cog(Eigen::Map<const Eigen::Vector3d>(rates + at_velocity) + base);
        const Eigen::Vector3d angular = body.R_GM * Eigen::Map<const Eigen::Vector3d>(rates + at_angular);
        for (Eigen::Index i = 0; 3 * i < rows; ++i) {
            const Eigen::Vector3d& r = model_.connections[i].position;
            const Eigen::Vector3d fixed_arm = frame.R_GF * r;
            markers.mobile_displacement.block<3, 1>(3 * i, k) =
                table + body.p_GM + body.R_GM * r - (rest_.mobile.p_GM + rest_.mobile.R_GM * r);
            markers.fixed_displacement.block<3, 1>(3 * i, k) =
                table + frame.p_GF + fixed_arm - (rest_frame.p_GF + rest_frame.R_GF * r);
            markers.mobile_acceleration.block<3, 1>(3 * i, k) =
                calcPointAcceleration(cog, angular, body.w_GM, body.R_GM * (r - model_.body.center_of_gravity));
            markers.fixed_acceleration.block<3, 1>(3 * i, k) =
                calcPointAcceleration(fixed.linear + base, fixed.angular, frame.w_GF, fixed_arm);
        }
    }
    return markers;
}

Bracket::FrameAcceleration ForwardModel::calcFrameAcceleration(const double* y, const double* rates, const Drive& drive,
                                                               int half) const {
    if (drive.prescribesMotion()) return drive.calcFrameAcceleration(half);
    const Eigen::Index modes = modeCount();
    if (modes == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    using StateMap = Eigen::Map<const Eigen::VectorXd>;
    return bracket_.calcAcceleration(StateMap(y + at_modes, modes), StateMap(y + at_modes + modes, modes),
                                     StateMap(rates + at_modes + modes, modes));
}

double ForwardModel::calcEnergy(const Simulation& simulation, const Drive& drive, int column) const {
    const ForwardState state = stateAt(simulation, drive, column);
    const int half = drive.grid().halfStepOf(simulation.first_sample + column);
    const BodyMotion& body = state.mobile;
    const Eigen::Vector3d arm = body.R_GM * model_.body.center_of_gravity;
    const Eigen::Vector3d w = body.R_GM.transpose() * body.w_GM;
    const Eigen::Vector3d v = body.v_GM + body.w_GM.cross(arm);
    double energy = 0.5 * model_.body.mass * v.squaredNorm() + 0.5 * w.dot(model_.body.inertia * w) -
                    model_.body.mass * model_.gravity.dot(body.p_GM + arm);
    if (state.eta.size() > 0) energy += bracket_.calcEnergy(state.eta, state.eta_dot);
    const FrameMotion frame = calcFrame(simulation.states.col(column).data(), drive, half);
    return energy + forces_.calcPotential(body, frame, drive.elapsedTime(half), state.internal.data());
}

double ForwardModel::calcDissipatedPower(const Simulation& simulation, const Drive& drive, int column) const {
    const ForwardState state = stateAt(simulation, drive, column);
    const int half = drive.grid().halfStepOf(simulation.first_sample + column);
    const FrameMotion frame = calcFrame(simulation.states.col(column).data(), drive, half);
    double power = forces_.calcDissipatedPower(state.mobile, frame, drive.elapsedTime(half), state.internal.data());
    if (state.eta.size() > 0) power += bracket_.calcDissipatedPower(state.eta_dot);
    return power;
}

}  // namespace wems::identify
