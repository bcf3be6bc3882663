#include "identify/fit/slow_offset.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "identify/fit/equation_of_motion.hpp"
#include "identify/fit/law_history.hpp"
#include "identify/motion/spectrum.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // force, moment about Mo, in G

constexpr double ringing_periods = 3;   // of the lowest trusted frequency, that the high pass rings at the end
constexpr double stop_over_pass = 1.5;  // band edges of the low pass; below the lowest excited frequency

/// Force (N) and tangent stiffness (N/m) of all stops of an axis.
struct Contact {
    double force = 0, stiffness = 0;
};
Contact calcContact(const AxisLaw& law, double q, double v) {
    Contact sum;
    for (const Stop& stop : law.stops) {
        const double side = stop.side == Side::positive ? 1 : -1;
        const double penetration = side * (q + law.offset) - stop.clearance;
        const double factor = std::max(0.0, 1 + stop.dissipation * side * v);
        if (penetration <= 0) continue;
        sum.force += side * stop.stiffness * penetration * factor;
        sum.stiffness += stop.stiffness * factor;
    }
    return sum;
}

/// Wrench that inertia and gravity demand.
Vector6d calcInertia(const PartMotion& motion, Eigen::Index k, const MountModel& model, const Matrix3d& about_origin) {
    const Matrix3d R = rotationFromVector(motion.theta.col(k));
    const Vector3d w = motion.w.col(k), alpha = motion.alpha.col(k), a = motion.a.col(k) - model.gravity;
    const Vector3d c = model.body.mass * (R * model.body.center_of_gravity);
    const Matrix3d inertia = R * about_origin * R.transpose();
    Vector6d wrench;
    wrench << model.body.mass * a + alpha.cross(c) + w.cross(w.cross(c)),
        c.cross(a) + inertia * alpha + w.cross(inertia * w + R * model.body.spin);
    return wrench;
}

struct Balance {
    Wrenches unbalanced;
    RowMatrix stiffness;  ///< samples × axes, tangent, N/m
};

Balance calcBalance(const RunMotion& motion, const MountModel& model) {
    const RelativeHistory relative = calcRelativeHistory(motion, model);
    const LawHistory laws = calcLawHistory(model, relative, motion.time);
    const RowMatrix& elastic = laws.elastic_is_displacement ? relative.q : laws.unit_elastic;
    const Vector3d& c = model.body.center_of_gravity;
    const Matrix3d about_origin =
        model.body.inertia + model.body.mass * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
    Balance balance{Wrenches(6, relative.q.rows()), RowMatrix(relative.q.rows(), relative.q.cols())};
    for (Eigen::Index k = 0; k < relative.q.rows(); ++k) {
        Vector6d wrench = calcInertia(motion.mobile, k, model, about_origin);
        const Matrix3d R_GM = rotationFromVector(motion.mobile.theta.col(k));
        const Matrix3d R_GF = rotationFromVector(motion.fixed.theta.col(k));
        for (Eigen::Index i = 0; 3 * i < relative.q.cols(); ++i) {
            const Connection& connection = model.connections[i];
            Vector3d force;
            for (int axis = 0; axis < 3; ++axis) {
                const Eigen::Index column = 3 * i + axis;
                const AxisLaw& law = connection.axis.at(axis);
                const Contact contact = calcContact(law, relative.q(k, column), relative.v(k, column));
                force(axis) = law.stiffness * elastic(k, column) + law.damping * relative.v(k, column) + contact.force +
                              (laws.known_is_zero ? 0.0 : laws.known(k, column));
                balance.stiffness(k, column) = law.stiffness + contact.stiffness;
            }
            force = R_GF * force;
            wrench.head<3>() += force;
            wrench.tail<3>() += (R_GM * connection.position).cross(force);
        }
        balance.unbalanced.col(k) = wrench;
    }
    return balance;
}

/// (translation of Mo, rotation) → displacement of each axis of each connection, at rest.
Eigen::MatrixXd makePattern(const MountModel& model) {
    Eigen::MatrixXd pattern(3 * model.connections.size(), 6);
    for (Eigen::Index i = 0; 3 * i < pattern.rows(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const Vector3d e = Vector3d::Unit(axis);
            pattern.row(3 * i + axis) << e.transpose(), model.connections[i].position.cross(e).transpose();
        }
    return pattern;
}

}  // namespace

bool lacksSlowMotion(const RunMotion& motion) {
    return !motion.mobile.displacement_measured && motion.mobile.acceleration_measured && motion.trusted_from > 0;
}

void cutRinging(RunMotion& motion) {
    const auto samples = static_cast<Eigen::Index>(motion.time.size());
    const Eigen::Index kept =
        samples -
        std::min(samples / 4, static_cast<Eigen::Index>(ringing_periods / (motion.trusted_from * motion.interval)));
    motion.time.resize(kept);
    for (PartMotion* part : {&motion.mobile, &motion.fixed})
        for (Eigen::Matrix3Xd* history : {&part->p, &part->theta, &part->v, &part->w, &part->a, &part->alpha})
            history->conservativeResize(Eigen::NoChange, kept);
    for (Eigen::Matrix3Xd* history : {&motion.load, &motion.base})
        if (history->cols() > kept) history->conservativeResize(Eigen::NoChange, kept);
}

double updateSlowOffset(RunMotion& motion, const MountModel& model) {
    const double pass = motion.trusted_from, stop = stop_over_pass * pass;
    Balance balance = calcBalance(motion, model);
    for (int e = 0; e < 6; ++e)
        balance.unbalanced.row(e) =
            keepSlowPart(balance.unbalanced.row(e).transpose(), motion.interval, pass, stop).x.transpose();
    for (Eigen::Index j = 0; j < balance.stiffness.cols(); ++j) {
        const Eigen::VectorXd history = balance.stiffness.col(j);
        const double least = history.minCoeff();
        if (history.maxCoeff() > least)
            balance.stiffness.col(j) =
                least + keepSlowPart(history.array() - least, motion.interval, pass, stop).x.array().max(0.0);
    }
    const Eigen::MatrixXd pattern = makePattern(model);
    Wrenches shift(6, balance.unbalanced.cols());
    for (Eigen::Index k = 0; k < shift.cols(); ++k) {
        const Matrix6d stiffness = pattern.transpose() * balance.stiffness.row(k).asDiagonal() * pattern;
        shift.col(k) = -stiffness.ldlt().solve(balance.unbalanced.col(k));
    }
    for (int e = 0; e < 6; ++e) {
        const SlowSignal slow = keepSlowPart(shift.row(e).transpose(), motion.interval, pass, stop);
        auto position = e < 3 ? motion.mobile.p.row(e) : motion.mobile.theta.row(e - 3);
        auto velocity = e < 3 ? motion.mobile.v.row(e) : motion.mobile.w.row(e - 3);
        position += slow.x.transpose();
        velocity += slow.rate.transpose();
        shift.row(e) = slow.x.transpose();
    }
    return std::sqrt((pattern * shift).squaredNorm() / static_cast<double>(pattern.rows() * shift.cols()));
}

}  // namespace wems::identify
