#include "synthetic_run.hpp"

#include <Eigen/Geometry>
#include <memory>
#include <random>

#include "models/bryant.hpp"
#include "models/excitation.hpp"
#include "models/mount_forces.hpp"

namespace wems::test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

/// State: p (3), quaternion wxyz (4), v (3), w (3), η, η', internal states.
class Device {
public:
    Device(const MountModel& model, const SweepSettings& settings)
        : model_(model),
          settings_(settings),
          mount_(model),
          bracket_(model.bracket),
          signal_(makeLogarithmicSweep(settings.from, settings.to, settings.octaves_per_minute)) {}

    double duration() const { return signal_->duration(); }
    Eigen::Index stateCount() const { return 13 + 2 * bracket_.modeCount() + mount_.stateCount(); }

    VectorXd makeRest() const {
        VectorXd y = VectorXd::Zero(stateCount());
        y(3) = 1;
        return y;
    }

    Vector3d calcLoad(double t) const { return settings_.force * signal_->value(t); }

    BodyMotion mobile(const VectorXd& y) const {
        BodyMotion motion;
        motion.p_GM = y.head<3>();
        motion.R_GM = Eigen::Quaterniond(y(3), y(4), y(5), y(6)).normalized().toRotationMatrix();
        motion.v_GM = y.segment<3>(7);
        motion.w_GM = y.segment<3>(10);
        return motion;
    }
    FrameMotion fixed(const VectorXd& y) const {
        return bracket_.calcMotion(y.segment(13, bracket_.modeCount()),
                                   y.segment(13 + bracket_.modeCount(), bracket_.modeCount()));
    }

    VectorXd derivative(double t, const VectorXd& y) const {
        const BodyMotion body = mobile(y);
        const FrameMotion frame = fixed(y);
        const int modes = bracket_.modeCount();
        VectorXd rate = VectorXd::Zero(y.size());
        Wrench on_mobile, on_fixed;
        mount_.calc(body, frame, t, y.data() + 13 + 2 * modes, on_mobile, on_fixed, rate.data() + 13 + 2 * modes);
        const Vector3d c = body.R_GM * model_.body.center_of_gravity;
        const Eigen::Matrix3d inertia = body.R_GM * model_.body.inertia * body.R_GM.transpose();
        const Vector3d spin = body.R_GM * model_.body.spin;
        const Vector3d moment = on_mobile.moment - c.cross(on_mobile.force);
        const Vector3d alpha =
            inertia.inverse() * (moment - body.w_GM.cross(inertia * body.w_GM) - body.w_GM.cross(spin));
        rate.head<3>() = body.v_GM;
        const Eigen::Quaterniond q(y(3), y(4), y(5), y(6));
        const Eigen::Quaterniond dq = Eigen::Quaterniond(0, body.w_GM.x(), body.w_GM.y(), body.w_GM.z()) * q;
        rate.segment<4>(3) << 0.5 * dq.w(), 0.5 * dq.x(), 0.5 * dq.y(), 0.5 * dq.z();
        rate.segment<3>(7) =
            on_mobile.force / model_.body.mass + model_.gravity - alpha.cross(c) - body.w_GM.cross(body.w_GM.cross(c));
        rate.segment<3>(10) = alpha;
        rate.segment(13, modes) = y.segment(13 + modes, modes);
        VectorXd eta_dot_dot(modes);
        bracket_.calcAccelerations(y.segment(13, modes), y.segment(13 + modes, modes), on_fixed, calcLoad(t),
                                   Vector3d::Zero(), eta_dot_dot);
        rate.segment(13 + modes, modes) = eta_dot_dot;
        return rate;
    }

    Bracket::FrameAcceleration calcFrameAcceleration(const VectorXd& y, const VectorXd& rate) const {
        const int modes = bracket_.modeCount();
        return bracket_.calcAcceleration(y.segment(13, modes), y.segment(13 + modes, modes),
                                         rate.segment(13 + modes, modes));
    }

private:
    MountModel model_;
    SweepSettings settings_;
    MountForces mount_;
    Bracket bracket_;
    std::unique_ptr<Signal> signal_;
};

}  // namespace

SyntheticRun simulateSweep(const MountModel& model, const SweepSettings& settings) {
    const Device device(model, settings);
    SyntheticRun run;
    run.model = model;
    run.interval = 1 / settings.sample_rate;
    const auto samples = static_cast<Eigen::Index>(device.duration() * settings.sample_rate);
    for (auto* series : {&run.p_M, &run.v_M, &run.w_M, &run.a_M, &run.alpha_M, &run.p_F, &run.v_F, &run.w_F, &run.a_F,
                         &run.alpha_F, &run.load})
        series->resize(3, samples);
    VectorXd y = device.makeRest();
    const double step = run.interval / settings.steps_per_sample;
    for (Eigen::Index k = 0; k < samples; ++k) {
        const double t = static_cast<double>(k) * run.interval;
        const VectorXd rate = device.derivative(t, y);
        const BodyMotion mobile = device.mobile(y);
        const FrameMotion fixed = device.fixed(y);
        const auto frame_acceleration = device.calcFrameAcceleration(y, rate);
        run.time.push_back(t);
        run.R_GM.push_back(mobile.R_GM);
        run.R_GF.push_back(fixed.R_GF);
        run.p_M.col(k) = mobile.p_GM;
        run.v_M.col(k) = mobile.v_GM;
        run.w_M.col(k) = mobile.w_GM;
        run.a_M.col(k) = rate.segment<3>(7);
        run.alpha_M.col(k) = rate.segment<3>(10);
        run.p_F.col(k) = fixed.p_GF;
        run.v_F.col(k) = fixed.v_GF;
        run.w_F.col(k) = fixed.w_GF;
        run.a_F.col(k) = frame_acceleration.linear;
        run.alpha_F.col(k) = frame_acceleration.angular;
        run.load.col(k) = device.calcLoad(t);
        for (int s = 0; s < settings.steps_per_sample; ++s) {
            const double now = t + s * step;
            const VectorXd k1 = device.derivative(now, y);
            const VectorXd k2 = device.derivative(now + step / 2, y + step / 2 * k1);
            const VectorXd k3 = device.derivative(now + step / 2, y + step / 2 * k2);
            const VectorXd k4 = device.derivative(now + step, y + step * k3);
            y += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            y.segment<4>(3).normalize();
        }
    }
    return run;
}

Eigen::Vector3d SyntheticRun::calcDisplacement(bool of_mobile, Eigen::Index k, const Eigen::Vector3d& position) const {
    const Eigen::Matrix3d& R = (of_mobile ? R_GM : R_GF)[k];
    return (of_mobile ? p_M : p_F).col(k) + R * position - position;
}

Eigen::Vector3d SyntheticRun::calcAcceleration(bool of_mobile, Eigen::Index k, const Eigen::Vector3d& position) const {
    const Eigen::Vector3d lever = (of_mobile ? R_GM : R_GF)[k] * position, rate = (of_mobile ? w_M : w_F).col(k),
                          turn = (of_mobile ? alpha_M : alpha_F).col(k);
    return (of_mobile ? a_M : a_F).col(k) + turn.cross(lever) + rate.cross(rate.cross(lever));
}

Recording record(const SyntheticRun& run, const SensorNoise& noise, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> gauss;
    Recording recording;
    recording.file = "synthetic.csv";
    recording.time = run.time;
    recording.first_row = 2;
    const auto add = [&](const std::string& name, const std::string& unit, const auto& value, double level) {
        Channel channel{name, unit, {}, static_cast<int>(recording.channels.size()) + 2};
        for (std::size_t k = 0; k < run.time.size(); ++k) channel.values.push_back(value(k) + level * gauss(generator));
        recording.channels.push_back(std::move(channel));
    };
    for (const bool is_mobile : {true, false}) {
        for (const auto& connection : run.model.connections) {
            const std::string prefix = (is_mobile ? "mobile." : "fixed.") + connection.name + ".";
            const Eigen::Vector3d& r = connection.position;
            for (int axis = 0; axis < 3; ++axis) {
                const std::string letter(1, "xyz"[axis]);
                if (noise.displacement >= 0)
                    add(
                        prefix + letter, "m",
                        [&](Eigen::Index k) { return run.calcDisplacement(is_mobile, k, r)(axis); },
                        noise.displacement);
                if (noise.acceleration >= 0)
                    add(
                        prefix + "a" + letter, "m/s^2",
                        [&](Eigen::Index k) { return run.calcAcceleration(is_mobile, k, r)(axis); },
                        noise.acceleration);
            }
        }
    }
    return recording;
}

MountModel perturb(const MountModel& model, double most, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> factor(1 - most, 1 + most);
    MountModel changed = model;
    for (auto& connection : changed.connections)
        for (auto& law : connection.axis) {
            law.stiffness *= factor(generator);
            law.damping *= factor(generator);
            for (auto& stop : law.stops) {
                stop.clearance *= factor(generator);
                stop.stiffness *= factor(generator);
            }
        }
    return changed;
}

}  // namespace wems::test
