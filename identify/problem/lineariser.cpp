#include "identify/problem/lineariser.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/problem/fast_motion.hpp"
#include "identify/problem/mount_equation.hpp"
#include "models/axis_law.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;
using Vector6c = Eigen::Matrix<Complex, 6, 1>;
using Vector12c = Eigen::Matrix<Complex, 12, 1>;

constexpr double kCountedFrom = 0.5;  // of the lowest excited frequency: where equations begin to count
constexpr double kCountedTo = 2.2;    // of the highest
constexpr double kOfPass = 0.9;       // and of the low pass

}  // namespace

Lineariser::Lineariser(const TestRun& test, const SensorLayout& layout, const TestState& state)
    : model_(state.model),
      open_(restoreFastMotion(makeOpenLoopRun(test.motion, model_, test.band, test.swept.hertz), model_)),
      slow_(followSlowMotion(open_, model_)),
      with_bracket_(BracketEquation::isAvailable(open_, model_)),
      spectra_(open_, std::max(kCountedFrom * test.band.lowest, slow_ ? slow_->highestBalanced() : open_.lowest),
               std::min(kCountedTo * test.band.highest, kOfPass * open_.pass)),
      motion_noise_(test, moveSensors(layout, state.sensors, test.recording)),
      noise_(test, open_, model_, motion_noise_, spectra_, slow_.get(), with_bracket_),
      bracket_(open_) {
    calcResiduals();
}

void Lineariser::prepareColumns() {
    if (with_bracket_) {
        const Eigen::MatrixXd inputs = bracket_.calcInputs(model_);
        inputs_ = spectra_.transform(inputs);
        input_spectra_ = bracket_.calcSpectra(inputs);
        for (const BracketMode& own : model_.bracket) modal_.push_back(makeModal(own));
    }
    const auto axes = 3 * static_cast<Eigen::Index>(model_.connections.size());
    forces_.resize(axes, open_.sampleCount());
    tangent_.resize(axes, open_.sampleCount());
    rest_tangent_.resize(axes);
    for (Eigen::Index row = 0; row < axes; ++row) {
        const AxisLaw& law = model_.connections[row / 3].axis[row % 3];
        forces_.row(row) = calcAxisForce(open_, law, static_cast<int>(row / 3), static_cast<int>(row % 3)).transpose();
        rest_tangent_[row] = AxisForce(law).calcStaticStiffness(0);
        tangent_.row(row) = calcTangent(open_, law, row).transpose();
        axis_tangents_.emplace_back(open_, law, row);
        const Vector6 d = calcAxisDirection(model_, static_cast<int>(row / 3), static_cast<int>(row % 3));
        mean_stiffness_ += axis_tangents_.back().meanStiffness() * d * d.transpose();
        mean_damping_ += axis_tangents_.back().meanDamping() * d * d.transpose();
        if ((tangent_.row(row).array() != rest_tangent_[row]).any()) addContact(row, d);
        unit_wrenches_.emplace_back();
        if (!axis_tangents_.back().isBeyondMean()) continue;
        varies_ = true;
        Eigen::MatrixXd wrench = Eigen::MatrixXd::Zero(6, open_.sampleCount());
        addAxisWrench(open_, model_, static_cast<int>(row / 3), static_cast<int>(row % 3),
                      Eigen::VectorXd::Ones(wrench.cols()), wrench);
        unit_wrenches_.back() = wrench;
    }
    spanContacts();
}

void Lineariser::addContact(Eigen::Index row, const Vector6& direction) {
    const Eigen::ArrayXd stop = tangent_.row(row).transpose().array() - tangent_.row(row).mean();
    const Eigen::ArrayXd beyond = (stop.square() - stop.square().mean()).max(0.0);
    Contact contact{direction, {}, {}, {}};
    for (Eigen::Index k = 0; k < beyond.size(); ++k)
        if (beyond[k] > 0) contact.instants.push_back(k);
    const std::size_t axis = row;
    contact.deviation = (open_.taper.array() * (noise_.contactVariance(axis) * beyond).sqrt())(contact.instants);
    contacts_.push_back(std::move(contact));
}

/// What a column has at the instants of contact is asked for along a basis of the touched axes' directions.
void Lineariser::spanContacts() {
    if (contacts_.empty()) return;
    Eigen::MatrixXd directions(6, contacts_.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i)
        directions.col(static_cast<Eigen::Index>(i)) = contacts_[i].direction;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(directions);
    const Eigen::MatrixXd basis = factor.householderQ() * Eigen::MatrixXd::Identity(6, factor.rank());
    contact_basis_ = basis;
    for (Contact& contact : contacts_) contact.along_basis = basis.transpose() * contact.direction;
}

Eigen::MatrixXcd Lineariser::whiten(const Eigen::MatrixXcd& mount, const Eigen::MatrixXcd& bracket) const {
    Eigen::MatrixXcd white = Eigen::MatrixXcd::Zero(12, spectra_.binCount());
    for (Eigen::Index b = 0; b < white.cols(); ++b) {
        const Matrix12c& L = noise_.whitener(b);
        Eigen::Map<Vector12c> values(&white(0, b));
        if (mount.size() > 0) {
            const Eigen::Map<const Vector6c> own(&mount(0, b));
            values.head<6>() += L.topLeftCorner<6, 6>().lazyProduct(own);
            if (with_bracket_) values.tail<6>() += L.bottomLeftCorner<6, 6>().lazyProduct(own);
        }
        if (with_bracket_ && bracket.size() > 0)
            values.tail<6>() += L.bottomRightCorner<6, 6>().lazyProduct(Eigen::Map<const Vector6c>(&bracket(0, b)));
    }
    return white;
}

Eigen::MatrixXcd Lineariser::transformMount(const Eigen::MatrixXd& wrench) const {
    return spectra_.transform(slow_ ? slow_->balance(wrench) : wrench);
}

Eigen::MatrixXcd Lineariser::calcLawColumn(const TestState& from, const TestState& to, int connection, int axis,
                                           double step) const {
    const auto c = static_cast<std::size_t>(connection), a = static_cast<std::size_t>(axis);
    const Eigen::VectorXd before = &from.model == &model_
                                       ? forces_.row(3 * connection + axis).transpose().eval()
                                       : calcAxisForce(open_, from.model.connections[c].axis[a], connection, axis);
    const Eigen::VectorXd change =
        (calcAxisForce(open_, to.model.connections[c].axis[a], connection, axis) - before) / step;
    if (change.isZero(0.0)) return {};
    Eigen::MatrixXd wrench = Eigen::MatrixXd::Zero(6, open_.sampleCount());
    addAxisWrench(open_, model_, connection, axis, change, wrench);
    return whiten(transformMount(wrench), {});
}

Eigen::VectorXd Lineariser::calcBursts(const Eigen::MatrixXcd& white) const {
    Eigen::Index count = 0;
    for (const Contact& contact : contacts_) count += contact.deviation.size();
    if (count == 0) return {};
    Eigen::MatrixXcd weighted(white.cols(), contact_basis_.cols());
    for (Eigen::Index b = 0; b < white.cols(); ++b) {
        const Vector6c own = noise_.whitener(b).topLeftCorner<6, 6>().adjoint() * white.col(b).head<6>();
        weighted.row(b) = own.transpose() * contact_basis_;
    }
    Eigen::MatrixXd series(open_.sampleCount(), weighted.cols());
    for (Eigen::Index i = 0; i < weighted.cols(); ++i) series.col(i) = spectra_.calcSeries(weighted.col(i));
    Eigen::VectorXd bursts(count);
    Eigen::Index first = 0;
    for (const Contact& contact : contacts_) {
        const Eigen::VectorXd along = series(contact.instants, Eigen::all) * contact.along_basis;
        bursts.segment(first, contact.deviation.size()) = along.cwiseProduct(contact.deviation);
        first += contact.deviation.size();
    }
    return bursts;
}

void Lineariser::calcBodyColumn(const MobileBody& behind, const MobileBody& ahead, double apart,
                                Eigen::MatrixXcd& mount, Eigen::MatrixXcd& bracket) const {
    const Eigen::MatrixXd change =
        (calcDemand(open_, ahead, model_.gravity) - calcDemand(open_, behind, model_.gravity)) / apart;
    mount = transformMount(change);
    if (!with_bracket_) return;
    bracket = transformBracket(0, bracket_.calcWrench(change));
}

Eigen::MatrixXcd Lineariser::calcPositionColumn(int connection, int axis) const {
    // With all of the turning, as the sensors' columns have it to second order: both move together without a trace.
    Eigen::Matrix3Xd q(3, open_.sampleCount()), v = q;
    Eigen::MatrixXd wrench = Eigen::MatrixXd::Zero(6, open_.sampleCount());
    for (Eigen::Index k = 0; k < q.cols(); ++k) {
        const Eigen::Matrix3d &R_M = open_.mobile.R[k], &R_F = open_.fixed.R[k];
        const Eigen::Vector3d arm = R_M.col(axis), rate = open_.mobile.w.col(k) - open_.fixed.w.col(k);
        q.col(k) = R_F.transpose() * arm - Eigen::Vector3d::Unit(axis);
        v.col(k) = R_F.transpose() * rate.cross(arm);
        wrench.col(k).tail<3>() = arm.cross(R_F * forces_.col(k).segment<3>(3 * connection));
    }
    Eigen::MatrixXcd relaxing = Eigen::MatrixXcd::Zero(6, spectra_.binCount());
    for (int a = 0; a < 3; ++a) {
        const AxisTangent& tangent = axis_tangents_[3 * connection + a];
        const Eigen::VectorXd own = q.row(a).transpose();
        addAxisWrench(open_, model_, connection, a, tangent.calcChange(own, v.row(a).transpose()), wrench);
        if (!tangent.relaxes()) continue;
        const Eigen::MatrixXcd spectrum = spectra_.transformSamples(own);
        const Vector6c d = calcAxisDirection(model_, connection, a).cast<Complex>();
        for (Eigen::Index b = 0; b < relaxing.cols(); ++b)
            relaxing.col(b) += spectrum(0, b) * tangent.calcRelaxing(spectra_.angular(b)) * d;
    }
    return transformMount(wrench) + relaxing;
}

Eigen::MatrixXd Lineariser::calcLoadOf(int axis) const {
    Eigen::MatrixXd load = calcLoad(open_, model_);
    for (Eigen::Index other = 0; axis < 3 && other < load.rows(); ++other)
        if (other != axis) load.row(other).setZero();
    return load;
}

void Lineariser::calcLoadColumn(const Eigen::MatrixXd& load, Eigen::MatrixXcd& mount, Eigen::MatrixXcd& bracket) const {
    if (model_.load_point) {
        const Eigen::MatrixXd wrench = calcLoadWrench(open_, *model_.load_point, load);
        if (loadsMobilePart(open_, model_)) mount = transformMount(-wrench);
        if (!with_bracket_) return;
        if (with_bracket_)
            bracket = transformBracket(0, loadsMobilePart(open_, model_) ? bracket_.calcWrench(-wrench) : wrench);
        return;
    }
    if (with_bracket_) bracket = transformBracket(6, load);
}

Eigen::MatrixXd Lineariser::calcHatLoad(const LoadHat& hat, double& share) const {
    Eigen::MatrixXd load = open_.load;
    for (Eigen::Index k = 0; k < load.cols(); ++k) {
        const double f = k < open_.swept.size() ? open_.swept[k] : std::nan("");
        double weight = 0;
        if (f > hat.below && f <= hat.at) weight = (f - hat.below) / (hat.at - hat.below);
        if (f > hat.at && f < hat.above) weight = (hat.above - f) / (hat.above - hat.at);
        load.col(k) *= weight;
        share += weight / static_cast<double>(load.cols());
    }
    return load;
}

Eigen::MatrixXcd Lineariser::calcMotionColumn(const SensorEffect& effect) const {
    Eigen::MatrixXcd white = Eigen::MatrixXcd::Zero(12, spectra_.binCount());
    const Eigen::Index first = effect.part == Part::mobile ? 0 : 6;
    for (Eigen::Index b = 0; b < white.cols(); ++b) {
        Vector6c motion = Vector6c::Zero();
        for (const auto& change : effect.changes) motion += change.spectrum[b] * change.direction.cast<Complex>();
        if (effect.correction.size() > 0) motion += effect.correction.col(b);
        const auto whitened = noise_.whitenedMotion(b).middleCols<6>(first);
        Eigen::Map<Vector12c> values(&white(0, b));
        values.head<6>() = whitened.topRows<6>().lazyProduct(motion);
        if (with_bracket_) values.tail<6>() = whitened.bottomRows<6>().lazyProduct(motion);
    }
    Eigen::MatrixXcd mount, bracket;
    if (!effect.groups.empty()) {
        mount = calcEdges(effect);
        if (varies_) mount += spectra_.transform(calcBeyondMean(effect));
        if (with_bracket_) bracket = calcBracketEdges(effect);
    }
    if (effect.wrench.size() > 0) {
        const Eigen::MatrixXcd wrench = effect.wrench.topRows(6) + effect.wrench.bottomRows(6);
        mount = mount.size() > 0 ? Eigen::MatrixXcd(mount + wrench) : wrench;
        if (with_bracket_ && bracket.size() == 0) bracket = Eigen::MatrixXcd::Zero(6, wrench.cols());
        for (Eigen::Index b = 0; b < bracket.cols(); ++b)
            bracket.col(b) -= noise_.receptance(b) * effect.wrench.col(b).head<6>();
    }
    if (mount.size() > 0) white += whiten(mount, bracket);
    return white;
}

Eigen::MatrixXcd Lineariser::calcEdges(const SensorEffect& effect) const {
    const bool mobile = effect.part == Part::mobile;
    const double sign = mobile ? 1.0 : -1.0;
    Eigen::MatrixXcd edges = Eigen::MatrixXcd::Zero(6, spectra_.binCount());
    for (const auto& group : effect.groups) {
        const Matrix6 terms[] = {sign * mean_stiffness_ * group.turn, sign * mean_damping_ * group.turn,
                                 calcMassMatrix(model_.body) * group.turn};
        for (std::size_t k = 0; k < (mobile ? 3 : 2); ++k)
            edges.noalias() += terms[k].cast<Complex>() * group.signals->edges.at(k);
    }
    return edges;
}

Eigen::MatrixXd Lineariser::calcBeyondMean(const SensorEffect& effect) const {
    const bool mobile = effect.part == Part::mobile;
    const double sign = mobile ? 1.0 : -1.0;
    Matrix6X contact = Matrix6X::Zero(6, open_.sampleCount());
    Matrix6X motion = contact, rate = contact;
    for (const auto& group : effect.groups) {
        motion.noalias() += group.turn * group.signals->samples.at(0).transpose();
        rate.noalias() += group.turn * group.signals->samples.at(1).transpose();
    }
    // The displacement along an axis is what the wrench of a unit force there does work on: at the connection, and for
    // the fixed part, at the same place of space.
    if (!mobile)
        for (Eigen::Index k = 0; k < contact.cols(); ++k) {
            const Eigen::Vector3d p_FM = open_.mobile.p.col(k) - open_.fixed.p.col(k);
            motion.col(k).head<3>() += motion.col(k).tail<3>().cross(p_FM);
            rate.col(k).head<3>() += rate.col(k).tail<3>().cross(p_FM);
        }
    for (std::size_t row = 0; row < axis_tangents_.size(); ++row) {
        if (!axis_tangents_[row].isBeyondMean()) continue;
        const Matrix6X& wrench = unit_wrenches_[row];
        const Eigen::VectorXd q = sign * wrench.cwiseProduct(motion).colwise().sum().transpose();
        const Eigen::VectorXd v = sign * wrench.cwiseProduct(rate).colwise().sum().transpose();
        const Eigen::VectorXd force = axis_tangents_[row].calcBeyondMean(q, v);
        for (Eigen::Index k = 0; k < contact.cols(); ++k) contact.col(k) += force[k] * wrench.col(k);
    }
    if (!slow_) return contact;
    // The slow motion follows what contact and the mean laws make together: what an error has below the band is
    // balanced, as the slow motion itself.
    Eigen::MatrixXd all = contact;
    for (const auto& group : effect.groups) {
        const Matrix6 stiffness = sign * mean_stiffness_ * group.turn, damping = sign * mean_damping_ * group.turn;
        all.noalias() += stiffness * group.signals->samples.at(0).transpose();
        all.noalias() += damping * group.signals->samples.at(1).transpose();
        if (mobile)
            all.noalias() += (calcMassMatrix(model_.body) * group.turn) * group.signals->samples.at(2).transpose();
    }
    return contact - slow_->calcForces(slow_->solve(all));
}

TurningWrench Lineariser::makeTurningWrench(Part part) const {
    const Eigen::Index connections = model_.connections.size();
    const bool mobile = part == Part::mobile, loaded = mobile && loadsMobilePart(open_, model_);
    TurningWrench wrench;
    wrench.forces.resize(3 * (connections + (loaded ? 1 : 0)), open_.sampleCount());
    wrench.forces.topRows(3 * connections) = forces_;
    if (loaded) wrench.forces.bottomRows(3) = -calcLoad(open_, model_);
    Eigen::VectorXd stiffness(3 * connections);
    for (Eigen::Index row = 0; row < stiffness.size(); ++row) stiffness[row] = axis_tangents_[row].meanStiffness();
    if (mobile && with_bracket_)
        wrench.modal_edges = [this](const Eigen::MatrixXd& accelerations, const Eigen::MatrixXcd& tapered) {
            return calcModalEdges(accelerations, tapered);
        };
    wrench.outputs = [&model = model_, stiffness, connections, mobile, loaded](const TurningInstant& at) {
        Eigen::VectorXd result = Eigen::VectorXd::Zero(12);
        if (mobile) result.head<6>() = calcDemand(model.body, model.gravity, at.R, at.w, at.a, at.alpha);
        const auto add = [&](const Eigen::Vector3d& force, const Eigen::Vector3d& arm) {
            result.segment<3>(6) += force;
            result.tail<3>() += arm.cross(force);
        };
        // q of a connection; without the error's motion the forces have it.
        const auto relate = [&](const Eigen::Vector3d& r, const Eigen::Matrix3d& own_R, const Eigen::Vector3d& p) {
            const Eigen::Vector3d p_FM = mobile ? Eigen::Vector3d(p - at.other_p) : Eigen::Vector3d(at.other_p - p);
            const Eigen::Matrix3d &R_M = mobile ? own_R : at.other_R, &R_F = mobile ? at.other_R : own_R;
            return Eigen::Vector3d(R_F.transpose() * (p_FM + R_M * r) - r);
        };
        for (Eigen::Index c = 0; c < connections; ++c) {
            const Eigen::Vector3d& r = model.connections[c].position;
            const Eigen::Vector3d moved = relate(r, at.R, at.p) - relate(r, at.unmoved_R, Eigen::Vector3d::Zero());
            const Eigen::Vector3d f = at.forces.segment<3>(3 * c) + stiffness.segment<3>(3 * c).cwiseProduct(moved);
            add((mobile ? at.other_R : at.R) * f, (mobile ? at.R : at.other_R) * r);
        }
        if (loaded) add(at.forces.tail<3>(), at.R * model.load_point->position);
        return result;
    };
    return wrench;
}

Eigen::MatrixXcd Lineariser::whitenDirection(const Vector6& d) const {
    Eigen::MatrixXcd white(6, spectra_.binCount());
    for (Eigen::Index b = 0; b < white.cols(); ++b)
        white.col(b) = noise_.whitener(b).topLeftCorner<6, 6>() * d.cast<Complex>();
    return white;
}

double Lineariser::calcContactShare() const {
    double inside = 0, all = 0;
    for (Eigen::Index k = 0; k < mount_series_.cols(); ++k) {
        const double power = open_.taper[k] * mount_series_.col(k).head<3>().squaredNorm();
        bool contact = false;
        for (Eigen::Index row = 0; row < tangent_.rows() && !contact; ++row)
            contact = tangent_(row, k) != rest_tangent_[row];
        all += power;
        if (contact) inside += power;
    }
    return all > 0 ? inside / all : 0;
}

void Lineariser::calcResiduals() {
    mount_series_ = calcMountResidual(open_, model_);
    Eigen::MatrixXcd bracket;
    if (with_bracket_) bracket = transformFixed(bracket_.calcResidual(model_));
    white_ = whiten(transformMount(mount_series_), bracket);
}

}  // namespace wems::identify
