#include "identify/exact/calibration.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "identify/exact/whitening.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

CalibrationResponse::CalibrationResponse(const OpenLoopRun& run, const MountModel& model,
                                         const BracketEquation* bracket)
    : run_(&run), model_(&model), bracket_(bracket), mass_(calcMassMatrix(model.body)) {
    const auto count = 3 * static_cast<Eigen::Index>(model.connections.size());
    tangent_.resize(count, run.sampleCount());
    axes_.resize(6, count);
    damping_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const AxisLaw& law = model.connections[i / 3].axis[i % 3];
        const AxisForce force(law);
        axes_.col(i) = calcAxisDirection(model, static_cast<int>(i / 3), static_cast<int>(i % 3));
        damping_[i] = law.damping;
        for (int k = 0; k < run.sampleCount(); ++k) tangent_(i, k) = force.calcStaticStiffness(run.q(i, k));
    }
    covariance_ = (axes_ * axes_.transpose()).inverse();
}

void CalibrationResponse::calcChannel(bool mobile, const Vector6& direction, Eigen::MatrixXd& mount,
                                      Eigen::MatrixXd& bracket) const {
    const SmoothPart& part = mobile ? run_->mobile : run_->fixed;
    const Vector6 shift = covariance_ * direction;
    const auto head = direction.head<3>().transpose(), tail = direction.tail<3>().transpose();
    const Eigen::RowVectorXd s = head * part.p + tail * part.theta, rate = head * part.v + tail * part.w;
    const double sign = mobile ? 1.0 : -1.0;
    mount = Eigen::MatrixXd::Zero(6, run_->sampleCount());
    for (Eigen::Index i = 0; i < axes_.cols(); ++i) {
        const double share = sign * axes_.col(i).dot(shift);
        mount += axes_.col(i) * (share * (tangent_.row(i).cwiseProduct(s) + damping_[i] * rate));
    }
    if (!mobile) {
        if (bracket_ != nullptr) bracket = -shift * s;
        return;
    }
    const Eigen::RowVectorXd acceleration = head * part.a + tail * part.alpha;
    const Eigen::MatrixXd demand = (mass_ * shift) * acceleration;
    mount += demand;
    if (bracket_ != nullptr) bracket = bracket_->calcResponse(*model_, bracket_->calcModalForces(*model_, demand));
}

void CalibrationResponse::calcChange(bool mobile, const Eigen::MatrixXd& motion, const Eigen::MatrixXd& rate,
                                     const Eigen::MatrixXd& acceleration, Eigen::MatrixXd& mount,
                                     Eigen::MatrixXd& bracket) const {
    const double sign = mobile ? 1.0 : -1.0;
    Eigen::MatrixXd force = axes_.transpose() * motion;
    force = sign * (tangent_.cwiseProduct(force) + damping_.asDiagonal() * (axes_.transpose() * rate));
    mount = axes_ * force;
    if (!mobile) {
        if (bracket_ != nullptr) bracket = -motion;
        return;
    }
    const Eigen::MatrixXd demand = mass_ * acceleration;
    mount += demand;
    if (bracket_ != nullptr) bracket = bracket_->calcResponse(*model_, bracket_->calcModalForces(*model_, demand));
}

void CalibrationResponse::calcSide(bool mobile, int number, Eigen::MatrixXd& mount, Eigen::MatrixXd& bracket) const {
    const SmoothPart& part = mobile ? run_->mobile : run_->fixed;
    const Eigen::Index count = run_->sampleCount();
    Eigen::MatrixXd s(6, count), v(6, count), a(6, count);
    s << part.p, part.theta;
    v << part.v, part.w;
    a << part.a, part.alpha;
    if (number == 0) {
        calcChange(mobile, -s, -v, -a, mount, bracket);
    } else if (number == 1) {
        // The rate of the acceleration, by differences of fourth order.
        Eigen::MatrixXd jerk = Eigen::MatrixXd::Zero(6, count);
        const Eigen::Index inner = count - 4;
        jerk.middleCols(2, inner) =
            (8 * (a.middleCols(3, inner) - a.middleCols(1, inner)) - (a.rightCols(inner) - a.leftCols(inner))) /
            (12 * run_->interval);
        calcChange(mobile, v, a, jerk, mount, bracket);
    } else {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(number - 2);
        for (auto* motion : {&s, &v, &a})
            for (Eigen::Index k = 0; k < count; ++k) {
                const Eigen::Vector3d upper = motion->block<3, 1>(0, k), lower = motion->block<3, 1>(3, k);
                motion->block<3, 1>(0, k) = upper.cross(axis);
                motion->block<3, 1>(3, k) = lower.cross(axis);
            }
        calcChange(mobile, s, v, a, mount, bracket);
    }
}

void CalibrationResponse::calc(Eigen::Index column, Eigen::MatrixXd& mount, Eigen::MatrixXd& bracket) const {
    const Eigen::Index channels = axes_.cols();
    mount.resize(0, 0);
    bracket.resize(0, 0);
    if (column < 2 * channels) {
        const bool mobile = column < channels;
        if (mobile || run_->fixed_measured) calcChannel(mobile, axes_.col(column % channels), mount, bracket);
        return;
    }
    if (bracket_ == nullptr || run_->load.cols() == 0) return;
    const Eigen::Index axis = column - 2 * channels;
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(model_->bracket.size(), run_->sampleCount());
    for (std::size_t j = 0; j < model_->bracket.size(); ++j)
        forces.row(j) = model_->bracket[j].load_translation[axis] * run_->load.row(axis);
    bracket = bracket_->calcResponse(*model_, forces);
}

}  // namespace wems::identify
