#include "identify/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "identify/motion/guided_part_motion.hpp"
#include "identify/motion/hum.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

namespace {

/// Vector signal of load or base, missing axes zero; empty if no axis was recorded.
Eigen::Matrix3Xd collectVector(const Recording& recording, Part part) {
    Eigen::Matrix3Xd values;
    for (const Channel& channel : recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || name->part != part) continue;
        const Eigen::Index samples = channel.values.size();
        if (values.cols() == 0) values = Eigen::Matrix3Xd::Zero(3, samples);
        values.row(name->axis) = Eigen::Map<const Eigen::RowVectorXd>(channel.values.data(), samples);
    }
    return values;
}

PartEstimate estimateFixed(const Recording& recording, const MountModel& model, const PartEstimate* base,
                           RunMotion& run, const BodyMotion& rest, ContactEdges edges) {
    if (hasChannels(recording, Part::fixed)) {
        const bool guided = model.body.free != MobileBody().free;
        const bool all_six = determinesPart(recording, model, Part::fixed, rest);
        // A rigid table whose own sensors tell too little is the base that it stands on.
        const bool follows_base = base != nullptr && model.bracket.empty();
        if (all_six || (!guided && !follows_base)) return estimatePart(recording, model, Part::fixed, rest, edges);
        if (guided && (!follows_base || determinesGuided(recording, model, Part::fixed, rest)))
            return estimateGuided(recording, model, Part::fixed, rest, makeStandstill(rest, run.time.size()), edges);
    }
    if (!model.bracket.empty())
        throw InputError({recording.file, 0, "fixed"},
                         "the model has a bracket, so the fixed part moves, but no channel of it was recorded",
                         "fixed.<connection>.<x|y|z|ax|ay|az>, or a model without [bracket]");
    if (base != nullptr) {
        run.fixed_source = FixedSource::base;
        return *base;
    }
    run.fixed_source = FixedSource::still;
    PartEstimate estimate;
    estimate.motion = makeStandstill(rest, run.time.size());
    estimate.trusted_to = 0.25 / run.interval;
    estimate.notes.emplace_back("fixed part: no channels and no bracket in the model, so it stands still");
    return estimate;
}

}  // namespace

RunMotion estimateMotion(const Recording& recording, const MountModel& model, ContactEdges edges) {
    if (!hasChannels(recording, Part::mobile))
        throw InputError({recording.file, 0, "mobile"}, "no channel of the mobile part",
                         "mobile.<connection>.<x|y|z|vx|vy|vz|ax|ay|az>");
    RunMotion run;
    run.file = recording.file;
    Recording uniform = makeUniform(recording, run.notes);
    removeDriveHum(uniform, run.notes);
    run.time = uniform.time;
    run.interval = uniform.sampleInterval();
    run.load = collectVector(uniform, Part::load);
    run.base = collectVector(uniform, Part::base);

    const StaticEquilibrium equilibrium = findStaticEquilibrium(model);
    const BodyMotion fixed_rest = findFixedRest(model, equilibrium);
    std::optional<PartEstimate> base;
    if (run.base.cols() > 0) {
        base = estimateTranslation(uniform, run.base, fixed_rest);
        run.base_displacement = base->motion.p.colwise() - fixed_rest.p_GM;
    }
    PartEstimate fixed, mobile;
    const auto findFixed = [&] {
        fixed = estimateFixed(uniform, model, base ? &*base : nullptr, run, fixed_rest, edges);
    };
    if (model.body.free == MobileBody().free) {
        runParallel(
            {findFixed, [&] { mobile = estimatePart(uniform, model, Part::mobile, equilibrium.mobile, edges); }});
    } else {
        findFixed();
        mobile = estimateGuided(uniform, model, Part::mobile, equilibrium.mobile, fixed.motion, edges);
    }
    run.mobile_trusted_from = mobile.trusted_from;
    run.fixed_trusted_from = fixed.trusted_from;
    run.trusted_from = std::max(mobile.trusted_from, fixed.trusted_from);
    run.trusted_to = std::min(mobile.trusted_to, fixed.trusted_to);
    run.sufficient_rate = std::max(mobile.sufficient_rate, fixed.sufficient_rate);
    run.notes.insert(run.notes.end(), mobile.notes.begin(), mobile.notes.end());
    run.notes.insert(run.notes.end(), fixed.notes.begin(), fixed.notes.end());
    run.mobile = std::move(mobile.motion);
    run.fixed = std::move(fixed.motion);
    return run;
}

}  // namespace wems::identify
