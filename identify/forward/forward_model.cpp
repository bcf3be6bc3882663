#include "identify/forward/forward_model.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <string>
#include <utility>

#include "models/error.hpp"
#include "models/load_gain.hpp"
#include "models/load_point.hpp"

namespace wems::identify {
namespace {

using Vector = Eigen::VectorXd;
using ConstMap = Eigen::Map<const Vector>;
using ConstMap3 = Eigen::Map<const Eigen::Vector3d>;
using Map = Eigen::Map<Vector>;
using Map3 = Eigen::Map<Eigen::Vector3d>;

Eigen::Matrix3d rotationFromQuaternion(const double* e) {
    const double s = 2 / (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    const double xx = s * e[1] * e[1], yy = s * e[2] * e[2], zz = s * e[3] * e[3];
    const double xy = s * e[1] * e[2], xz = s * e[1] * e[3], yz = s * e[2] * e[3];
    const double wx = s * e[0] * e[1], wy = s * e[0] * e[2], wz = s * e[0] * e[3];
    Eigen::Matrix3d R;
    R << 1 - yy - zz, xy - wz, xz + wy, xy + wz, 1 - xx - zz, yz - wx, xz - wy, yz + wx, 1 - xx - yy;
    return R;
}

/// A stop may touch at rest, where the offset exceeds its clearance.
bool hasForceAtRest(const MountModel& model) {
    for (const Connection& connection : model.connections) {
        for (const AxisLaw& law : connection.axis)
            if (AxisForce(law).calcStaticForce(0) != 0) return true;
    }
    return false;
}

}  // namespace

SimulationDiverged::SimulationDiverged(double time)
    : std::runtime_error("the simulated motion grew beyond all bounds at " + std::to_string(time) + " s") {}

struct ForwardModel::Forcing {
    const Drive& drive;
    Vector gain;  // of the load at all table rows; empty = 1

    Eigen::Vector3d load(int half) const {
        if (drive.load().cols() == 0) return Eigen::Vector3d::Zero();
        return (gain.size() == 0 ? 1.0 : gain(half)) * drive.load().col(half);
    }
    Eigen::Vector3d base(int half) const {
        if (drive.base().cols() == 0) return Eigen::Vector3d::Zero();
        return drive.base().col(half);
    }
};

ForwardModel::ForwardModel(MountModel model)
    : model_(std::move(model)),
      forces_(model_),
      bracket_(model_.bracket),
      guide_(model_.body),
      inverse_inertia_(model_.body.inertia.inverse()) {
    const Eigen::Index modes = modeCount();
    rest_displacement_ = Vector::Zero(3 * static_cast<Eigen::Index>(forces_.connectionCount()));
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
            rest_displacement_.segment<3>(3 * static_cast<Eigen::Index>(i)) =
                calcRelativeMotion(rest_.mobile, frame, model_.connections[static_cast<std::size_t>(i)].position).q;
    }
    rest_.eta_dot = Vector::Zero(modes);
}

Vector ForwardModel::calcGains(const Drive& drive) const {
    if (!model_.load || drive.load().cols() == 0) return {};
    const Vector& frequency = drive.sweptFrequency();
    if (frequency.size() == 0) {
        if (dependsOnFrequency(*model_.load))
            throw InputError({{}, 0, "load.gain_over_frequency"},
                             "the recorded load is no sine sweep whose frequency could be told from its zero crossings",
                             "a sweep, or a single `gain`");
        return Vector::Constant(drive.load().cols(), calcLoadGain(*model_.load, 0));
    }
    Vector gains(frequency.size());
    for (Eigen::Index k = 0; k < gains.size(); ++k) gains[k] = calcLoadGain(*model_.load, frequency[k]);
    return gains;
}

Eigen::Index ForwardModel::stateSize(const Drive& drive) const {
    return at_modes + (drive.prescribesMotion() ? 0 : 2 * modeCount()) + forces_.stateCount();
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

BodyMotion ForwardModel::calcBody(const double* y) const {
    BodyMotion body;
    body.R_GM = rotationFromQuaternion(y + at_quaternion);
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

void ForwardModel::calcRates(const double* y, const Forcing& forcing, int half, double* rates) const {
    const Eigen::Index modes = forcing.drive.prescribesMotion() ? 0 : modeCount();
    const Eigen::Index at_internal = at_modes + 2 * modes;
    const BodyMotion body = calcBody(y);
    Bracket::Kinematics fixed;
    if (modes > 0) {
        fixed = bracket_.calcKinematics(ConstMap(y + at_modes, modes), ConstMap(y + at_modes + modes, modes));
    } else if (forcing.drive.prescribesMotion()) {
        fixed.motion = forcing.drive.frame(half);
    }
    Wrench on_mobile, on_fixed;
    forces_.calc(body, fixed.motion, forcing.drive.elapsedTime(half), y + at_internal, on_mobile, on_fixed,
                 rates + at_internal);
    const Eigen::Vector3d load =
        applyLoad(model_.load_point, body, fixed.motion, forcing.load(half), on_mobile, on_fixed);

    const Eigen::Vector3d base = forcing.base(half);
    const ConstMap3 w(y + at_angular);
    const double* e = y + at_quaternion;
    Map3(rates + at_position) = ConstMap3(y + at_velocity);
    Eigen::Map<Eigen::Vector4d>(rates + at_quaternion) << -0.5 * (e[1] * w[0] + e[2] * w[1] + e[3] * w[2]),
        0.5 * (e[0] * w[0] + e[2] * w[2] - e[3] * w[1]), 0.5 * (e[0] * w[1] + e[3] * w[0] - e[1] * w[2]),
        0.5 * (e[0] * w[2] + e[1] * w[1] - e[2] * w[0]);
    Map3(rates + at_velocity) = on_mobile.force / model_.body.mass + model_.gravity - base;
    const Eigen::Vector3d arm = ConstMap3(y + at_position) - body.p_GM;
    const Eigen::Vector3d moment = on_mobile.moment - arm.cross(on_mobile.force);
    const Eigen::Vector3d momentum = model_.body.inertia * w + model_.body.spin;
    Map3(rates + at_angular) = inverse_inertia_ * (body.R_GM.transpose() * moment - w.cross(momentum));

    if (modes > 0) {
        const ConstMap eta(y + at_modes, modes), eta_dot(y + at_modes + modes, modes);
        Map(rates + at_modes, modes) = eta_dot;
        bracket_.calcAccelerations(fixed.jacobian, eta, eta_dot, on_fixed, load, base,
                                   Map(rates + at_modes + modes, modes));
    }
    if (guide_.active())
        guide(y, body, fixed, forcing, half, {moment, on_mobile.force + model_.body.mass * (model_.gravity - base)},
              rates);
}

void ForwardModel::guide(const double* y, const BodyMotion& body, const Bracket::Kinematics& fixed,
                         const Forcing& forcing, int half, const Wrench& applied, double* rates) const {
    const Eigen::Index modes = forcing.drive.prescribesMotion() ? 0 : modeCount();
    Eigen::MatrixXd frame_jacobian(6, modes);
    Vector6 frame_bias = Vector6::Zero();
    if (modes > 0) {
        frame_jacobian = bracket_.calcFrameJacobian(fixed.jacobian);
        const Bracket::FrameAcceleration bias = bracket_.calcAcceleration(
            ConstMap(y + at_modes, modes), ConstMap(y + at_modes + modes, modes), Vector::Zero(modes));
        frame_bias << bias.linear, bias.angular;
    } else if (forcing.drive.prescribesMotion()) {
        const Bracket::FrameAcceleration bias = forcing.drive.calcFrameAcceleration(half);
        frame_bias << bias.linear, bias.angular;
    }
    const Vector6 acceleration = guide_.calcAcceleration(body, fixed.motion, frame_bias, applied, frame_jacobian,
                                                         Map(rates + at_modes + modes, modes), 0);
    Map3(rates + at_velocity) = acceleration.head<3>();
    Map3(rates + at_angular) = body.R_GM.transpose() * acceleration.tail<3>();
}

void ForwardModel::project(double* y, const Drive& drive, int half) const {
    ForwardState state = unpack(y, drive);
    guide_.project(state.mobile, calcFrame(y, drive, half));
    pack(state, drive, y);
}

void ForwardModel::calcDisplacement(const double* y, const Drive& drive, int half, double* q) const {
    const BodyMotion body = calcBody(y);
    const FrameMotion frame = calcFrame(y, drive, half);
    for (const Connection& connection : model_.connections) {
        const Eigen::Vector3d& r = connection.position;
        Map3{q} = frame.R_GF.transpose() * (body.p_GM + body.R_GM * r - frame.p_GF) - r;
        q += 3;
    }
}

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
    const Forcing forcing{drive, calcGains(drive)};

    const Eigen::Index size = stateSize(drive);
    Vector y(size), stage(size), k1(size), k2(size), k3(size), k4(size);
    pack(initial, drive, y.data());
    if (guide_.active()) project(y.data(), drive, grid.halfStepOf(first_sample));
    Simulation result;
    result.first_sample = first_sample;
    result.q.resize(rest_displacement_.size(), sample_count);
    if (keep == Keep::states) {
        result.states.resize(size, sample_count);
        result.rates.resize(size, sample_count);
    }
    const double h = grid.step();
    int half = grid.halfStepOf(first_sample);
    for (int sample = 0; sample < sample_count; ++sample) {
        calcDisplacement(y.data(), drive, half, result.q.col(sample).data());
        if (!std::isfinite(y.squaredNorm())) throw SimulationDiverged(grid.halfStepTime(half));
        if (keep == Keep::states) {
            result.states.col(sample) = y;
            calcRates(y.data(), forcing, half, result.rates.col(sample).data());
        }
        if (sample + 1 == sample_count) break;
        for (int step = 0; step < grid.steps_per_sample; ++step, half += 2) {
            calcRates(y.data(), forcing, half, k1.data());
            stage = y + (0.5 * h) * k1;
            calcRates(stage.data(), forcing, half + 1, k2.data());
            stage = y + (0.5 * h) * k2;
            calcRates(stage.data(), forcing, half + 1, k3.data());
            stage = y + h * k3;
            calcRates(stage.data(), forcing, half + 2, k4.data());
            y += (h / 6) * (k1 + 2 * (k2 + k3) + k4);
            y.segment<4>(at_quaternion).normalize();
            if (guide_.active()) project(y.data(), drive, half + 2);
        }
    }
    result.final_state = unpack(y.data(), drive);
    return result;
}

}  // namespace wems::identify
