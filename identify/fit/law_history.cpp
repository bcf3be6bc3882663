#include "identify/fit/law_history.hpp"

#include <algorithm>

#include "models/bryant.hpp"
#include "models/law_equality.hpp"
#include "models/mount_forces.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {

namespace {

void fillHistory(const AxisLaw& law, Eigen::Index column, const RelativeHistory& relative,
                 const std::vector<double>& time, RowMatrix& result) {
    const Eigen::Map<const Eigen::VectorXd> at(time.data(), time.size());
    result.col(column) = calcForceAlong(law, at, relative.q.col(column), relative.v.col(column));
}

AxisLaw unitElasticPart(const AxisLaw& law) {
    AxisLaw part;
    part.stiffness = 1;
    part.loss_factor = law.loss_factor;
    part.drift = law.drift;
    part.relaxation = law.relaxation;
    part.spectrum = law.spectrum;
    return part;
}

AxisLaw knownPart(const AxisLaw& law) {
    AxisLaw part = law;
    part.stiffness = part.damping = part.loss_factor = part.drift = 0;
    part.relaxation.reset();
    part.spectrum.clear();
    part.stops.clear();
    for (auto stop = law.stops.begin(); stop != law.stops.end(); ++stop) {
        const auto same_side = [&](const Stop& other) { return other.side == stop->side; };
        if (std::any_of(law.stops.begin(), stop, same_side)) part.stops.push_back(*stop);
    }
    return part;
}

}  // namespace

RelativeHistory calcRelativeHistory(const RunMotion& motion, const MountModel& model) {
    const auto samples = static_cast<Eigen::Index>(motion.time.size());
    const Eigen::Index axes = 3 * model.connections.size();
    RelativeHistory history{RowMatrix(samples, axes), RowMatrix(samples, axes)};
    for (Eigen::Index k = 0; k < samples; ++k) {
        BodyMotion mobile;
        mobile.R_GM = rotationFromVector(motion.mobile.theta.col(k));
        mobile.p_GM = motion.mobile.p.col(k);
        mobile.v_GM = motion.mobile.v.col(k);
        mobile.w_GM = motion.mobile.w.col(k);
        FrameMotion fixed;
        fixed.R_GF = rotationFromVector(motion.fixed.theta.col(k));
        fixed.p_GF = motion.fixed.p.col(k);
        fixed.v_GF = motion.fixed.v.col(k);
        fixed.w_GF = motion.fixed.w.col(k);
        Eigen::Index column = 0;
        for (const auto& connection : model.connections) {
            const RelativeMotion relative = calcRelativeMotion(mobile, fixed, connection.position);
            history.q.row(k).segment<3>(column) = relative.q.transpose();
            history.v.row(k).segment<3>(column) = relative.v.transpose();
            column += 3;
        }
    }
    return history;
}

LawHistory calcLawHistory(const MountModel& model, const RelativeHistory& relative, const std::vector<double>& time) {
    LawHistory history;
    for (const auto& connection : model.connections)
        for (const auto& law : connection.axis) {
            if (law.loss_factor != 0 || law.drift != 0 || law.relaxation || !law.spectrum.empty())
                history.elastic_is_displacement = false;
            AxisLaw nothing;
            nothing.offset = law.offset;
            if (!(knownPart(law) == nothing)) history.known_is_zero = false;
        }
    if (!history.elastic_is_displacement) history.unit_elastic.resize(relative.q.rows(), relative.q.cols());
    if (!history.known_is_zero) history.known.resize(relative.q.rows(), relative.q.cols());
    Eigen::Index column = 0;
    for (const auto& connection : model.connections)
        for (const auto& law : connection.axis) {
            if (!history.elastic_is_displacement)
                fillHistory(unitElasticPart(law), column, relative, time, history.unit_elastic);
            if (!history.known_is_zero) fillHistory(knownPart(law), column, relative, time, history.known);
            ++column;
        }
    return history;
}

RowMatrix calcForceHistory(const MountModel& model, const RelativeHistory& relative, const std::vector<double>& time) {
    RowMatrix force(relative.q.rows(), relative.q.cols());
    Eigen::Index column = 0;
    for (const auto& connection : model.connections)
        for (const auto& law : connection.axis) fillHistory(law, column++, relative, time, force);
    return force;
}

}  // namespace wems::identify
