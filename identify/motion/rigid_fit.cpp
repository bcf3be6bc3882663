#include "identify/motion/rigid_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "models/bryant.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

namespace {

using FoundChannel = std::pair<MarkerChannel, const Channel*>;

MarkerChannel makeMarker(const std::string& channel, const ChannelName& name, const MountModel& model) {
    MarkerChannel marker;
    marker.name = channel;
    marker.station = name.connection;
    marker.axis = name.axis;
    const int place_index = model.placeIndex(name);
    if (place_index < 0) {
        marker.index = model.connectionIndex(name.connection);
        marker.position = model.connections[marker.index].position;
        marker.direction = Eigen::Vector3d::Unit(name.axis);
        return marker;
    }
    const SensorPlace& place = model.places[place_index];
    marker.index = static_cast<int>(model.connections.size()) + place_index;
    marker.position = place.position;
    marker.direction = place.direction(name.axis);
    marker.turning = place.accelerometer;
    return marker;
}

/// Weights from the noise that the layout states; a channel without a statement has the noise of the best.
void setWeights(std::vector<FoundChannel>& found, const MountModel& model) {
    const auto noiseOf = [&](const MarkerChannel& marker) {
        const int place = marker.index - static_cast<int>(model.connections.size());
        return place < 0 ? 0.0 : model.places[place].noise;
    };
    double least = 0;
    for (const auto& [marker, channel] : found) {
        const double noise = noiseOf(marker);
        if (noise > 0 && (least == 0 || noise < least)) least = noise;
    }
    for (auto& [marker, channel] : found) {
        const double noise = noiseOf(marker);
        if (noise > 0) marker.weight = least / noise;
    }
}

}  // namespace

bool MarkerChannel::isPlain() const {
    return !turning && weight == 1 && direction == Eigen::Vector3d::Unit(axis);
}

bool ChannelSet::hasCompleteTriads() const {
    if (channels.size() % 3 != 0) return false;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        if (channels[i].axis != static_cast<int>(i % 3) || !channels[i].isPlain()) return false;
        if (channels[i].index != channels[i - i % 3].index) return false;
    }
    return true;
}

ChannelSet collectChannels(const Recording& recording, const MountModel& model, Part part, Derivative derivative) {
    ChannelSet set;
    set.file = recording.file;
    set.part = part;
    set.derivative = derivative;
    std::vector<FoundChannel> found;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part != part || name->derivative != derivative) continue;
        found.emplace_back(makeMarker(channel.name, *name, model), &channel);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first.index, a.first.axis) < std::pair(b.first.index, b.first.axis);
    });
    setWeights(found, model);
    const Eigen::Index samples = recording.sampleCount();
    set.values.resize(found.size(), samples);
    for (const auto& [marker, channel] : found) {
        const auto bad = std::find_if_not(channel->values.begin(), channel->values.end(),
                                          [](double value) { return std::isfinite(value); });
        if (bad != channel->values.end())
            throw InputError({recording.file, recording.first_row + (bad - channel->values.begin()), channel->name},
                             "the value is not a finite number");
        set.channels.push_back(marker);
    }
    // Sample by sample within blocks that stay in the cache.
    constexpr Eigen::Index block = 512;
    for (Eigen::Index start = 0; start < samples; start += block) {
        const Eigen::Index count = std::min(block, samples - start);
        for (std::size_t i = 0; i < found.size(); ++i)
            set.values.row(i).segment(start, count) =
                Eigen::Map<const Eigen::RowVectorXd>(found[i].second->values.data() + start, count);
    }
    return set;
}

namespace {

constexpr int max_steps = 40;
/// Steps below this (m, rad) end the iteration: convergence is quadratic but for a term of the residual's relative
/// size.
constexpr double step_tolerance = 1e-8;
/// A rotation step (rad) above this is too far for Gauss–Newton to be trusted.
constexpr double large_step = 0.3;

/// Undoes the slow drift of a product of many rotations away from orthogonality: one Newton step of the polar factor.
void orthonormalize(Eigen::Matrix3d& R) {
    R = R * (1.5 * Eigen::Matrix3d::Identity() - 0.5 * R.transpose() * R).eval();
}

}  // namespace

Eigen::MatrixXd makeDesign(const std::vector<MarkerChannel>& channels, const Eigen::Vector3d& origin, double length) {
    Eigen::MatrixXd design(channels.size(), 6);
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const Eigen::Vector3d& e = channels[i].direction;
        const Eigen::Vector3d r = channels[i].position - origin;
        design.row(i) << e.transpose(), r.cross(e).transpose() / length;
    }
    return design;
}

RigidFit::RigidFit(ChannelSet set, const BodyMotion& rest)
    : set_(std::move(set)), rest_(rest), triads_(set_.hasCompleteTriads()) {
    rest_ends_.resize(set_.count());
    for (int i = 0; i < set_.count(); ++i) {
        const MarkerChannel& channel = set_.channels[i];
        rest_ends_[i] = channel.direction.dot(rest_.p_GM + rest_.R_GM * channel.position);
    }
    findUndetermined();
    if (!undetermined_.empty() || !triads_) return;
    points_.resize(3, set_.count() / 3);
    for (int i = 0; i < points_.cols(); ++i) points_.col(i) = set_.channels[3 * i].position;
    pseudo_inverse_ =
        makeDesign(set_.channels, Eigen::Vector3d::Zero(), 1.0).completeOrthogonalDecomposition().pseudoInverse();
}

void RigidFit::findUndetermined() {
    static const char* const names[] = {"translation x",    "translation y",    "translation z",
                                        "rotation about x", "rotation about y", "rotation about z"};
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const MarkerChannel& channel : set_.channels) centre += channel.position / set_.count();
    double length = 0;
    for (const MarkerChannel& channel : set_.channels)
        length += (channel.position - centre).squaredNorm() / set_.count();
    length = std::sqrt(length);
    if (!(length > 0)) length = 1;
    Matrix6 normal = Matrix6::Zero();
    if (!set_.empty()) {
        const Eigen::MatrixXd design = makeDesign(set_.channels, centre, length);
        normal = design.transpose() * design;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(normal);
    // Singular value ratio 1e-3: noise of the lost motion would be a thousand times that of a channel.
    const double limit = 1e-6 * std::max(solver.eigenvalues()[5], 1e-300);
    for (int motion = 0; motion < 6; ++motion) {
        double share = 0;
        for (int j = 0; j < 6; ++j) {
            if (solver.eigenvalues()[j] <= limit) share += std::pow(solver.eigenvectors()(motion, j), 2);
        }
        if (share > 0.05) undetermined_.emplace_back(names[motion]);
    }
}

Eigen::Matrix<double, 6, 1> RigidFit::calcUnitDeviations() const {
    return calcUnitCovariance().diagonal().cwiseSqrt();
}

Eigen::Matrix<double, 6, 6> RigidFit::calcUnitCovariance() const {
    const Eigen::MatrixXd design = weigh(makeDesign(set_.channels, Eigen::Vector3d::Zero(), 1.0));
    const Matrix6 normal = design.transpose() * design;
    return normal.inverse();
}

Eigen::MatrixXd RigidFit::weigh(const Eigen::MatrixXd& residuals) const {
    Eigen::MatrixXd weighted = residuals;
    for (int i = 0; i < set_.count(); ++i) weighted.row(i) *= set_.channels[i].weight;
    return weighted;
}

BodyMotion RigidFit::calcKabsch(const Eigen::Matrix3Xd& ends) const {
    const Eigen::Vector3d centre = points_.rowwise().mean();
    const Eigen::Vector3d end_centre = ends.rowwise().mean();
    const Eigen::Matrix3d correlation = (ends.colwise() - end_centre) * (points_.colwise() - centre).transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d U = svd.matrixU();
    if (U.determinant() * svd.matrixV().determinant() < 0) U.col(2) = -U.col(2);
    BodyMotion pose;
    pose.R_GM = U * svd.matrixV().transpose();
    pose.p_GM = end_centre - pose.R_GM * centre;
    return pose;
}

bool RigidFit::refineTriads(const Eigen::Matrix3Xd& ends, BodyMotion& pose) const {
    Eigen::Matrix3Xd error(3, points_.cols());
    for (int step = 0; step < max_steps; ++step) {
        error.noalias() = pose.R_GM.transpose() * (ends.colwise() - pose.p_GM);
        error -= points_;
        const Vector6 change = pseudo_inverse_ * Eigen::Map<const Eigen::VectorXd>(error.data(), error.size());
        const Eigen::Vector3d turn = change.tail<3>();
        if (!(turn.norm() < large_step)) return false;
        pose.p_GM += pose.R_GM * change.head<3>();
        pose.R_GM = pose.R_GM * rotationFromVector(turn);
        if (change.cwiseAbs().maxCoeff() < step_tolerance) {
            orthonormalize(pose.R_GM);
            return true;
        }
    }
    return false;
}

Eigen::Vector3d RigidFit::calcDirection(int channel, const Eigen::Matrix3d& R) const {
    const MarkerChannel& marker = set_.channels[channel];
    if (marker.turning) return R * marker.direction;
    return marker.direction;
}

RigidFit::Vector6 RigidFit::calcRow(int channel, const Eigen::Matrix3d& R) const {
    const MarkerChannel& marker = set_.channels[channel];
    const Eigen::Vector3d direction = calcDirection(channel, R);
    Vector6 row;
    row << direction, (R * marker.position).cross(direction);
    return marker.weight * row;
}

bool RigidFit::refineRows(const Eigen::Ref<const Eigen::VectorXd>& ends, BodyMotion& pose) const {
    for (int step = 0; step < max_steps; ++step) {
        Matrix6 normal = Matrix6::Zero();
        Vector6 right = Vector6::Zero();
        for (int i = 0; i < set_.count(); ++i) {
            const MarkerChannel& marker = set_.channels[i];
            const Vector6 row = calcRow(i, pose.R_GM);
            const double error =
                marker.weight * (ends[i] - marker.direction.dot(pose.p_GM + pose.R_GM * marker.position));
            normal.noalias() += row * row.transpose();
            right += error * row;
        }
        const Vector6 change = normal.ldlt().solve(right);
        if (!change.allFinite()) return false;
        const double share = std::min(1.0, large_step / std::max(change.tail<3>().norm(), 1e-300));
        pose.p_GM += share * change.head<3>();
        pose.R_GM = rotationFromVector(share * change.tail<3>()) * pose.R_GM;
        if (change.cwiseAbs().maxCoeff() < step_tolerance) {
            orthonormalize(pose.R_GM);
            return true;
        }
    }
    return false;
}

void RigidFit::solvePoses(Eigen::Matrix3Xd& p, Eigen::Matrix3Xd& theta, Eigen::MatrixXd* residuals) const {
    const Eigen::Index samples = set_.values.cols();
    p.resize(3, samples);
    theta.resize(3, samples);
    if (residuals) residuals->resize(set_.count(), samples);
    BodyMotion pose = rest_;
    Eigen::Vector3d advance = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    Eigen::Matrix3Xd ends(3, points_.cols());
    Eigen::VectorXd channel_ends(set_.count());
    for (Eigen::Index k = 0; k < samples; ++k) {
        channel_ends = rest_ends_ + set_.values.col(k);
        bool converged = false;
        if (triads_) {
            ends = Eigen::Map<const Eigen::Matrix3Xd>(channel_ends.data(), 3, points_.cols());
            if (k == 0) pose = calcKabsch(ends);
            // Straight on from the two samples before: one step fewer.
            const BodyMotion before = pose;
            pose.p_GM += advance;
            pose.R_GM = pose.R_GM * turn;
            converged = refineTriads(ends, pose);
            advance = pose.p_GM - before.p_GM;
            turn = before.R_GM.transpose() * pose.R_GM;
            if (!converged) {
                pose = calcKabsch(ends);
                converged = refineTriads(ends, pose);
                advance.setZero();
                turn.setIdentity();
            }
        } else {
            converged = refineRows(channel_ends, pose);
            if (!converged) {
                pose = rest_;
                converged = refineRows(channel_ends, pose);
            }
        }
        if (!converged)
            throw InputError(
                {set_.file, 0, set_.channels.front().name},
                "sample " + std::to_string(k + 1) + ": no rigid motion fits the displacement channels of this part");
        p.col(k) = pose.p_GM;
        theta.col(k) = vectorFromRotation(pose.R_GM);
        if (!residuals) continue;
        for (int i = 0; i < set_.count(); ++i) {
            const MarkerChannel& marker = set_.channels[i];
            (*residuals)(i, k) = channel_ends[i] - marker.direction.dot(pose.p_GM + pose.R_GM * marker.position);
        }
    }
}

void RigidFit::solveAccelerations(const Eigen::Matrix3Xd& theta, const Eigen::Matrix3Xd& w, Eigen::Matrix3Xd& a,
                                  Eigen::Matrix3Xd& alpha, Eigen::MatrixXd* residuals) const {
    const Eigen::Index samples = set_.values.cols();
    a.resize(3, samples);
    alpha.resize(3, samples);
    if (residuals) residuals->resize(set_.count(), samples);
    Eigen::Matrix3Xd field(3, points_.cols());
    Eigen::VectorXd reduced(set_.count());
    for (Eigen::Index k = 0; k < samples; ++k) {
        const Eigen::Matrix3d R = rotationFromVector(theta.col(k));
        if (triads_) {
            const Eigen::Vector3d w_body = R.transpose() * w.col(k);
            const Eigen::Matrix3d W = crossMatrix(w_body);
            field.noalias() =
                R.transpose() * Eigen::Map<const Eigen::Matrix3Xd>(set_.values.col(k).data(), 3, points_.cols());
            field.noalias() -= (W * W) * points_;
            const Vector6 solution = pseudo_inverse_ * Eigen::Map<const Eigen::VectorXd>(field.data(), field.size());
            a.col(k) = R * solution.head<3>();
            alpha.col(k) = R * solution.tail<3>();
        } else {
            Matrix6 normal = Matrix6::Zero();
            Vector6 right = Vector6::Zero();
            for (int i = 0; i < set_.count(); ++i) {
                const MarkerChannel& marker = set_.channels[i];
                const Vector6 row = calcRow(i, R);
                const Eigen::Vector3d r = R * marker.position;
                const double centripetal = calcDirection(i, R).dot(w.col(k).cross(w.col(k).cross(r)));
                const double value = marker.weight * (set_.values(i, k) - centripetal);
                normal.noalias() += row * row.transpose();
                right += value * row;
            }
            const Vector6 solution = normal.ldlt().solve(right);
            a.col(k) = solution.head<3>();
            alpha.col(k) = solution.tail<3>();
        }
        if (!residuals) continue;
        const Eigen::Matrix3d A = crossMatrix(alpha.col(k)), W = crossMatrix(w.col(k));
        const Eigen::Matrix3d field_matrix = (A + W * W) * R;
        for (int i = 0; i < set_.count(); ++i) {
            const MarkerChannel& marker = set_.channels[i];
            (*residuals)(i, k) = set_.values(i, k) - calcDirection(i, R).dot(a.col(k) + field_matrix * marker.position);
        }
    }
}

}  // namespace wems::identify
