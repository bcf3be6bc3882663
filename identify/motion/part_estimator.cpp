#include "identify/motion/part_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "identify/motion/differentiation.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

ChannelSet PartEstimator::collectAccelerations(const MountModel& model, const ChannelSet& displacements) {
    ChannelSet set = collectChannels(recording_, model, part_, Derivative::acceleration);
    ChannelSet velocity = collectChannels(recording_, model, part_, Derivative::velocity);
    if (velocity.empty()) return set;
    if (!set.empty() || !displacements.empty()) {
        note("velocity channels are not used: displacements or accelerations say more");
        return set;
    }
    from_velocity_ = true;
    for (Eigen::Index i = 0; i < velocity.count(); ++i)
        velocity.values.row(i) = differentiate(velocity.values.row(i).transpose(), interval_).first.transpose();
    note("accelerations are central differences (eighth order) of the velocity channels");
    return velocity;
}

void PartEstimator::begin(bool displacement, bool acceleration) {
    result_.trusted_to = 0.25 / interval_;
    PartMotion& motion = result_.motion;
    motion.displacement_measured = displacement;
    motion.acceleration_measured = acceleration && !from_velocity_;
    motion.displacement_noise = motion.acceleration_noise = std::nan("");
}

double PartEstimator::chooseCutoff(const Eigen::MatrixXd& coordinates) {
    const double cutoff = std::clamp(kSweepMargin * findSweptFrequency(recording_).highest,
                                     findCutoff(coordinates, interval_), 0.25 / interval_);
    result_.trusted_to = 0.5 * cutoff;
    const double end = findAccelerationEnd(coordinates, interval_), enough = 1 / (interval_ * result_.trusted_to);
    if (cutoff >= 0.25 / interval_ && end > result_.trusted_to) {
        result_.sufficient_rate = enough * end;
        note("sampled too coarsely for derivatives: of the acceleration's power more than a tenth lies above " +
             formatHertz(result_.trusted_to) + "; sample at " + formatHertz(result_.sufficient_rate) +
             " or more, or record accelerations");
    }
    return cutoff;
}

void PartEstimator::noteDerivatives(double cutoff) {
    note(
        "no accelerations recorded: velocities and accelerations are zero-phase derivatives of the displacements "
        "(gain 1/2 at " +
        formatHertz(cutoff) + "), good to " + formatHertz(result_.trusted_to));
}

void PartEstimator::chooseIntegrationBand() {
    const double lowest = findSweptFrequency(recording_).lowest;
    if (!(lowest > 0))
        throw InputError({recording_.file, 0, key()},
                         "only accelerations, and nothing moves: no displacement can be derived");
    result_.trusted_from = kIntegrationMargin * lowest;
}

void PartEstimator::noteIntegration() {
    note("no displacements recorded: accelerations integrated twice, zero-phase; displacements say nothing below " +
         formatHertz(result_.trusted_from) + " (0.6 of the lowest excited frequency), no static offset either");
}

void PartEstimator::note(const std::string& text) {
    result_.notes.push_back(std::string(key()) + " part: " + text);
}

void PartEstimator::throwUndetermined(const std::string& kind, const std::vector<std::string>& motions,
                                      const std::string& accepted) const {
    std::string names;
    for (const std::string& name : motions) names += (names.empty() ? "" : ", ") + name;
    throw InputError({recording_.file, 0, key()},
                     "the " + kind + " channels of this part do not determine its " + names, accepted);
}

}  // namespace wems::identify
