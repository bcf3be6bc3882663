#include "identify/motion/rigidity.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <optional>

#include "identify/motion/motion.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

/// A layout counts as a cross if its arms are perpendicular and centred to this, relative.
constexpr double cross_tolerance = 1e-3;

using EndPositions = std::vector<Eigen::Matrix3Xd>;  // one for each end, 3 x samples

/// Ends 0-1 and 2-3 of a cross, as indices.
std::optional<std::array<int, 4>> findCross(const std::vector<Eigen::Vector3d>& ends) {
    if (ends.size() != 4) return std::nullopt;
    static const std::array<std::array<int, 4>, 3> pairings{{{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};
    for (const auto& p : pairings) {
        const auto at = [&](int i) { return ends[p[i]]; };
        const Eigen::Vector3d first = at(1) - at(0), second = at(3) - at(2);
        const double length = 0.5 * (first.norm() + second.norm());
        const double cosine = first.dot(second) / (first.norm() * second.norm());
        const double offset = (0.5 * (at(0) + at(1) - at(2) - at(3))).norm() / length;
        if (std::abs(cosine) < cross_tolerance && offset < cross_tolerance) return p;
    }
    return std::nullopt;
}

class PartCheck {
public:
    PartCheck(const Recording& recording, Part part, Rigidity& result)
        : recording_(recording), part_(part), result_(result) {}

    void checkDisplacements(const ChannelSet& set, const BodyMotion& rest, double noise) {
        noise_ = noise;
        names_.clear();
        rests_.clear();
        ends_.clear();
        for (int i = 0; i + 2 < set.count(); ++i) {
            const MarkerChannel& channel = set.channels[i];
            const MarkerChannel& last = set.channels[i + 2];
            const bool triad =
                channel.axis == 0 && set.channels[i + 1].axis == 1 && last.axis == 2 && last.index == channel.index;
            // The distance of two ends needs all axes of both along the same directions.
            if (!triad || channel.direction != Eigen::Vector3d::UnitX() || last.direction != Eigen::Vector3d::UnitZ())
                continue;
            names_.push_back(channel.station);
            rests_.push_back(rest.R_GM * channel.position + rest.p_GM);
            ends_.emplace_back(set.values.middleRows(i, 3).colwise() + rests_.back());
        }
        if (ends_.size() < 2) {
            result_.notes.push_back(prefix() + "fewer than two connections with x, y and z: no lengths to check");
            return;
        }
        const auto cross = findCross(rests_);
        if (cross) checkCross(*cross);
        for (int i = 0; i < static_cast<int>(ends_.size()); ++i) {
            for (int j = i + 1; j < static_cast<int>(ends_.size()); ++j) {
                const bool done =
                    cross && (isPair(i, j, (*cross)[0], (*cross)[1]) || isPair(i, j, (*cross)[2], (*cross)[3]));
                if (!done) checkLength(i, j);
            }
        }
    }

    void checkField(const ChannelSet& set, const Eigen::MatrixXd& residuals, double noise) {
        const double largest = set.values.cwiseAbs().maxCoeff();
        if (!(largest > 0)) return;
        for (int first = 0; first < set.count();) {
            const MarkerChannel& station = set.channels[first];
            int count = 0;
            while (first + count < set.count() && set.channels[first + count].index == station.index) ++count;
            const double noise_percent = 100 * noise * std::sqrt(count) / largest;
            add("acceleration field " + station.station,
                100 / largest * residuals.middleRows(first, count).colwise().norm().transpose(), noise_percent);
            first += count;
        }
    }

private:
    static bool isPair(int i, int j, int a, int b) { return (i == a && j == b) || (i == b && j == a); }

    std::string prefix() const { return part_ == Part::fixed ? "fixed " : ""; }
    const Eigen::Matrix3Xd& end(int i) const { return ends_[i]; }
    const Eigen::Vector3d& restOf(int i) const { return rests_[i]; }
    const std::string& nameOf(int i) const { return names_[i]; }

    void checkLength(int i, int j) {
        const double length = (restOf(i) - restOf(j)).norm();
        add("length " + nameOf(i) + "-" + nameOf(j),
            100 * ((end(i) - end(j)).colwise().norm().transpose().array() / length - 1),
            100 * noise_ * std::sqrt(2) / length);
    }

    void checkCross(const std::array<int, 4>& cross) {
        checkLength(cross[0], cross[1]);
        checkLength(cross[2], cross[3]);
        const double first_length = (restOf(cross[0]) - restOf(cross[1])).norm();
        const double second_length = (restOf(cross[2]) - restOf(cross[3])).norm();
        const Eigen::Matrix3Xd first = end(cross[1]) - end(cross[0]), second = end(cross[3]) - end(cross[2]);
        const Eigen::VectorXd cosine = first.cwiseProduct(second).colwise().sum().transpose().array() /
                                       (first.colwise().norm().array() * second.colwise().norm().array()).transpose();
        add("perpendicularity", 100 * (cosine.array().acos() - kPi / 2) / (kPi / 2),
            100 * noise_ * std::sqrt(2 / (first_length * first_length) + 2 / (second_length * second_length)) /
                (kPi / 2));
        const double length = 0.5 * (first_length + second_length);
        const Eigen::Matrix3Xd offset = 0.5 * (end(cross[0]) + end(cross[1]) - end(cross[2]) - end(cross[3]));
        for (int axis = 0; axis < 3; ++axis)
            add(std::string("midpoint ") + "xyz"[axis], 100 / length * offset.row(axis).transpose(),
                100 * noise_ / length);
    }

    void add(const std::string& name, const Eigen::VectorXd& percent, double noise_percent) {
        RigidityCheck check;
        check.name = prefix() + name;
        check.percent = percent;
        Eigen::Index at = 0;
        check.max_percent = percent.cwiseAbs().maxCoeff(&at);
        check.at_time = recording_.time[at];
        check.at_frequency = result_.swept.hertz[at];
        check.noise_percent = noise_percent;
        result_.checks.push_back(check);
    }

    const Recording& recording_;
    Part part_;
    Rigidity& result_;
    double noise_ = 0;
    std::vector<std::string> names_;
    std::vector<Eigen::Vector3d> rests_;
    EndPositions ends_;
};

void addSuspects(Rigidity& result, const ChannelSet& set, const Eigen::MatrixXd& residuals,
                 const Eigen::MatrixXd& coordinates, double noise, double interval) {
    const Eigen::MatrixXd fitted = makeDesign(set.channels, Eigen::Vector3d::Zero(), 1.0) * coordinates;
    for (ChannelSuspect& suspect : findSuspects(set.channels, fitted, residuals, noise, interval))
        result.suspects.push_back(std::move(suspect));
}

void checkPart(const Recording& recording, const MountModel& model, Part part, const BodyMotion& rest,
               Rigidity& result) {
    const PartEstimate estimate = estimatePart(recording, model, part, rest);
    const PartMotion& motion = estimate.motion;
    const std::string name = part == Part::mobile ? "mobile part: " : "fixed part: ";
    PartCheck check(recording, part, result);
    const double interval = recording.sampleInterval();
    const auto redundant = [&](const RigidFit& fit) {
        if (fit.redundancy() > 0) return true;
        result.notes.push_back(name + "six channels only, which fit any rigid motion: nothing to check");
        return false;
    };
    Eigen::MatrixXd residuals, coordinates(6, recording.sampleCount());
    if (motion.displacement_measured) {
        const RigidFit fit(collectChannels(recording, model, part, Derivative::displacement), rest);
        if (redundant(fit)) {
            Eigen::Matrix3Xd p, theta;
            fit.solvePoses(p, theta, &residuals);
            check.checkDisplacements(fit.channelSet(), rest, motion.displacement_noise);
            coordinates << p.colwise() - rest.p_GM, theta;
            addSuspects(result, fit.channelSet(), residuals, coordinates, motion.displacement_noise, interval);
        }
    }
    if (motion.acceleration_measured) {
        const RigidFit fit(collectChannels(recording, model, part, Derivative::acceleration), rest);
        if (redundant(fit)) {
            Eigen::Matrix3Xd a, alpha;
            fit.solveAccelerations(motion.theta, motion.w, a, alpha, &residuals);
            if (!motion.displacement_measured) {
                check.checkField(fit.channelSet(), residuals, motion.acceleration_noise);
                result.notes.push_back(name + "accelerations only: the checks are on the rigid acceleration field");
            }
            coordinates << a, alpha;
            addSuspects(result, fit.channelSet(), residuals, coordinates, motion.acceleration_noise, interval);
        }
    }
}

}  // namespace

Rigidity checkRigidity(const Recording& recording, const MountModel& model) {
    Rigidity result;
    const Recording uniform = makeUniform(recording, result.notes);
    result.time = uniform.time;
    result.swept = findSweptFrequency(uniform);
    const StaticEquilibrium equilibrium = findStaticEquilibrium(model);
    bool any = false;
    for (const Part part : {Part::mobile, Part::fixed}) {
        if (!hasChannels(uniform, part)) continue;
        any = true;
        checkPart(uniform, model, part, part == Part::mobile ? equilibrium.mobile : findFixedRest(model, equilibrium),
                  result);
    }
    if (!any)
        throw InputError({recording.file, 0, "mobile"}, "no channels of the mobile or the fixed part",
                         "mobile.<connection>.<x|y|z|ax|ay|az>, fixed.<connection>.<…>");
    return result;
}

}  // namespace wems::identify
