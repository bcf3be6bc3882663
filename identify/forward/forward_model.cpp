#include "identify/forward/forward_model.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/common/error.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

namespace {

using Vector = Eigen::VectorXd;
using ConstMap = Eigen::Map<const Vector>;
using ConstMap3 = Eigen::Map<const Eigen::Vector3d>;
using Map = Eigen::Map<Vector>;
using Map3 = Eigen::Map<Eigen::Vector3d>;

/// A stop may touch at rest, where the offset exceeds its clearance.
bool hasForceAtRest(const MountModel& model) {
    for (const Connection& connection : model.connections) {
        for (const AxisLaw& law : connection.axis)
            if (AxisForce(law).calcStaticForce(0) != 0) return true;
    }
    return false;
}

}  // namespace

ForwardModel::ForwardModel(MountModel model)
    : model_(std::move(model)), forces_(model_), bracket_(model_.bracket), guide_(model_.body), kernel_(model_) {
    const Eigen::Index modes = modeCount();
    rest_displacement_ = Vector::Zero(3 * forces_.connectionCount());
    if (model_.gravity.isZero() && !hasForceAtRest(model_)) {
        rest_.eta = Vector::Zero(modes);
        rest_.internal = Vector::Zero(forces_.stateCount());
    } else {
        const StaticEquilibrium equilibrium = findStaticEquilibrium(model_);
        rest_.mobile = equilibrium.mobile;
        rest_.eta = equilibrium.eta;
        rest_.internal = equilibrium.states;
        const FrameMotion frame = modes > 0 ? bracket_.calcMotion(rest_.eta, Vector::Zero(modes)) : FrameMotion();
        for (int i = 0; i < forces_.connectionCount(); ++i)
            rest_displacement_.segment<3>(3 * i) =
                calcRelativeMotion(rest_.mobile, frame, model_.connections[i].position).q;
    }
    rest_.eta_dot = Vector::Zero(modes);
}

Eigen::Matrix3Xd ForwardModel::calcGains(const Drive& drive) const {
    if (!model_.load || drive.load().cols() == 0) return {};
    const Vector& frequency = drive.sweptFrequency();
    if (frequency.size() == 0) {
        if (dependsOnFrequency(*model_.load))
            throw InputError({{}, 0, "load.gain_over_frequency"},
                             "the recorded load is no sine sweep whose frequency could be told from its zero crossings",
                             "a sweep, or a single `gain`");
        return calcLoadGains(*model_.load, 0).replicate(1, drive.load().cols());
    }
    Eigen::Matrix3Xd gains(3, frequency.size());
    for (Eigen::Index k = 0; k < gains.cols(); ++k) gains.col(k) = calcLoadGains(*model_.load, frequency[k]);
    return gains;
}

Eigen::Index ForwardModel::stateSize(const Drive& drive) const {
    return kernel_.stateSize(drive.prescribesMotion());
}

void ForwardModel::pack(const ForwardState& state, const Drive& drive, double* y) const {
    const BodyMotion& body = state.mobile;
    const Eigen::Vector3d arm = body.R_GM * model_.body.center_of_gravity;
    const Eigen::Quaterniond quaternion(body.R_GM);
    Map3(y + at_position) = body.p_GM + arm;
    Eigen::Map<Eigen::Vector4d>(y + at_quaternion) << quaternion.w(), quaternion.vec();
    Map3(y + at_velocity) = body.v_GM + body.w_GM.cross(arm);
    Map3(y + at_angular) = body.R_GM.transpose() * body.w_GM;
    double* next = y + at_modes;
    if (!drive.prescribesMotion()) {
        if (state.eta.size() != modeCount() || state.eta_dot.size() != modeCount())
            throw std::invalid_argument("ForwardModel: the state does not have the model's bracket modes");
        Map(next, modeCount()) = state.eta;
        Map(next + modeCount(), modeCount()) = state.eta_dot;
        next += 2 * modeCount();
    }
    if (state.internal.size() != forces_.stateCount())
        throw std::invalid_argument("ForwardModel: the state does not have the model's internal states");
    Map(next, forces_.stateCount()) = state.internal;
}

Vector ForwardModel::packState(const ForwardState& state, const Drive& drive) const {
    Vector y(stateSize(drive));
    pack(state, drive, y.data());
    return y;
}

BodyMotion ForwardModel::calcBody(const double* y) const {
    BodyMotion body;
    body.R_GM = Eigen::Quaterniond(y[at_quaternion], y[at_quaternion + 1], y[at_quaternion + 2], y[at_quaternion + 3])
                    .normalized()
                    .toRotationMatrix();
    body.w_GM = body.R_GM * ConstMap3(y + at_angular);
    const Eigen::Vector3d arm = body.R_GM * model_.body.center_of_gravity;
    body.p_GM = ConstMap3(y + at_position) - arm;
    body.v_GM = ConstMap3(y + at_velocity) - body.w_GM.cross(arm);
    return body;
}

FrameMotion ForwardModel::calcFrame(const double* y, const Drive& drive, int half) const {
    if (drive.prescribesMotion()) return drive.frame(half);
    if (modeCount() == 0) return {};
    return bracket_.calcMotion(ConstMap(y + at_modes, modeCount()), ConstMap(y + at_modes + modeCount(), modeCount()));
}

ForwardState ForwardModel::unpack(const double* y, const Drive& drive) const {
    ForwardState state;
    state.mobile = calcBody(y);
    const Eigen::Index modes = drive.prescribesMotion() ? 0 : modeCount();
    state.eta = ConstMap(y + at_modes, modes);
    state.eta_dot = ConstMap(y + at_modes + modes, modes);
    state.internal = ConstMap(y + at_modes + 2 * modes, forces_.stateCount());
    return state;
}

/// What the integration asks of held motions.
class ForwardModel::Guides {
public:
    Guides(const ForwardModel& forward, const Drive& drive) : forward_(forward), drive_(drive) {}

    /// Accelerations with the guides' reactions. @param place in half steps
    void correct(const double* y, const Forcing<double>& forcing, double place, double* rates) const {
        const GuidedMotion& guide = forward_.guide_;
        if (!guide.active()) return;
        const Eigen::Index modes = drive_.prescribesMotion() ? 0 : forward_.modeCount();
        const BodyMotion body = forward_.calcBody(y);
        const ConstMap eta(y + at_modes, modes), eta_dot(y + at_modes + modes, modes);
        FrameMotion fixed;
        Eigen::MatrixXd frame_jacobian(6, modes);
        Vector6 frame_bias = Vector6::Zero();
        if (modes > 0) {
            const Bracket::Kinematics kinematics = forward_.bracket_.calcKinematics(eta, eta_dot);
            fixed = kinematics.motion;
            frame_jacobian = forward_.bracket_.calcFrameJacobian(kinematics.jacobian);
            const Bracket::FrameAcceleration bias =
                forward_.bracket_.calcAcceleration(eta, eta_dot, Vector::Zero(modes));
            frame_bias << bias.linear, bias.angular;
        } else if (drive_.prescribesMotion()) {
            fixed = collectFrame(forcing);
            const Bracket::FrameAcceleration bias = drive_.calcFrameAcceleration(static_cast<int>(std::lround(place)));
            frame_bias << bias.linear, bias.angular;
        }
        // What is applied, from the accelerations that it would give the free body.
        const MobileBody& mobile = forward_.model_.body;
        const ConstMap3 w(y + at_angular);
        const Eigen::Vector3d momentum = mobile.inertia * w + mobile.spin;
        const Eigen::Vector3d moment = body.R_GM * (mobile.inertia * ConstMap3(rates + at_angular) + w.cross(momentum));
        const Eigen::Vector3d force = mobile.mass * ConstMap3(rates + at_velocity);
        const Vector6 acceleration = guide.calcAcceleration(body, fixed, frame_bias, {moment, force}, frame_jacobian,
                                                            Map(rates + at_modes + modes, modes), 0);
        Map3(rates + at_velocity) = acceleration.head<3>();
        Map3(rates + at_angular) = body.R_GM.transpose() * acceleration.tail<3>();
    }

    void project(double* y, const Forcing<double>& forcing) const {
        if (!forward_.guide_.active()) return;
        ForwardState state = forward_.unpack(y, drive_);
        FrameMotion fixed;
        if (drive_.prescribesMotion()) {
            fixed = collectFrame(forcing);
        } else if (forward_.modeCount() > 0) {
            fixed = forward_.bracket_.calcMotion(state.eta, state.eta_dot);
        }
        forward_.guide_.project(state.mobile, fixed);
        forward_.pack(state, drive_, y);
    }

private:
    static FrameMotion collectFrame(const Forcing<double>& forcing) {
        FrameRow row{};
        forcing.R_GF.x.store(row.R_GF);
        forcing.R_GF.y.store(row.R_GF + 3);
        forcing.R_GF.z.store(row.R_GF + 6);
        forcing.p_GF.store(row.p_GF);
        forcing.w_GF.store(row.w_GF);
        forcing.v_GF.store(row.v_GF);
        return makeFrameMotion(row);
    }

    const ForwardModel& forward_;
    const Drive& drive_;
};

ForwardState ForwardModel::restState(const Drive& drive) const {
    if (!drive.prescribesMotion()) return rest_;
    ForwardState state = rest_;
    FrameMotion rest_frame;
    if (modeCount() > 0) rest_frame = bracket_.calcMotion(rest_.eta, rest_.eta_dot);
    state.mobile = composeMotion(drive.frame(0), calcRelativeCoordinates(rest_.mobile, rest_frame), Vector6::Zero());
    return state;
}

Simulation ForwardModel::simulate(const Drive& drive, Keep keep) const {
    return simulate(drive, restState(drive), 0, drive.grid().samples, keep);
}

Simulation ForwardModel::simulate(const Drive& drive, const ForwardState& initial, int first_sample, int sample_count,
                                  Keep keep) const {
    const TimeGrid& grid = drive.grid();
    if (first_sample < 0 || sample_count < 1 || first_sample + sample_count > grid.samples)
        throw std::invalid_argument("ForwardModel::simulate: samples outside the drive's grid");
    const Eigen::Matrix3Xd gains = calcGains(drive);
    const Eigen::Index size = stateSize(drive);
    const Vector initial_state = packState(initial, drive);
    Vector last(size);
    Simulation result;
    result.first_sample = first_sample;
    result.q.resize(rest_displacement_.size(), sample_count);
    LaneRun lane_run;
    lane_run.initial = initial_state.data();
    if (gains.size() > 0) lane_run.gain = gains.data();
    lane_run.q = result.q.data();
    lane_run.last = last.data();
    if (keep == Keep::states) {
        result.states.resize(size, sample_count);
        result.rates.resize(size, sample_count);
        lane_run.states = result.states.data();
        lane_run.rates = result.rates.data();
    }
    const StepPlan plan = kernel_.makePlan(drive, first_sample, sample_count);
    const MountKernel<double> kernel = kernel_.makeKernel(kernel_.constants().data(), drive.prescribesMotion());
    std::vector<double> work(plan.workSize(kernel.connections));
    if (guide_.active()) {
        Stepper<double, 1, Guides>(kernel, plan, Guides(*this, drive), &lane_run, work.data()).run();
    } else {
        Stepper<double, 1, NoGuides<double>>(kernel, plan, {}, &lane_run, work.data()).run();
    }
    if (lane_run.diverged_at >= 0) throw SimulationDiverged(grid.halfStepTime(lane_run.diverged_at));
    result.final_state = unpack(last.data(), drive);
    result.evaluations = lane_run.evaluations;
    return result;
}

// What a simulation with kept states can tell beyond relative displacements: markers and energy.

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
