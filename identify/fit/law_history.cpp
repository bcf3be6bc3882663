#include "identify/fit/law_history.hpp"

#include <algorithm>
#include <cmath>

#include "identify/fit/drag.hpp"
#include "models/bryant.hpp"
#include "models/law_equality.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {
namespace {

/// Moves the internal states over a step: branches as if the displacement were linear in time, what is dragged along
/// its cubic.
void advanceStates(const AxisForce& force, const AxisStep<double>& step, std::vector<double>& z) {
    std::size_t next = 0;
    for (const MaxwellBranch& branch : force.branches()) {
        const double lag = branch.time_constant * (step.q1 - step.q0) / step.h;
        z[next] = step.q1 - lag + (z[next] - step.q0 + lag) * std::exp(-step.h / branch.time_constant);
        ++next;
    }
    dragAlong(force, step, z.data());
}

void fillHistory(const AxisLaw& law, Eigen::Index column, const RelativeHistory& relative,
                 const std::vector<double>& time, RowMatrix& result) {
    const AxisForce force(law);
    std::vector<double> z(static_cast<std::size_t>(force.stateCount()), 0.0);
    for (std::size_t b = 0; b < force.branches().size(); ++b) z[b] = relative.q(0, column);
    for (Eigen::Index k = 0; k < relative.q.rows(); ++k) {
        const double q = relative.q(k, column), v = relative.v(k, column), t = time[static_cast<std::size_t>(k)];
        if (k > 0 && !z.empty()) {
            const double interval = t - time[static_cast<std::size_t>(k - 1)];
            advanceStates(force, {relative.q(k - 1, column), relative.v(k - 1, column), q, v, interval}, z);
        }
        result(k, column) = force.calcForce(q, v, t - time.front(), z.data());
    }
}

AxisLaw unitElasticPart(const AxisLaw& law) {
    AxisLaw part;
    part.stiffness = 1;
    part.loss_factor = law.loss_factor;
    part.drift = law.drift;
    part.relaxation = law.relaxation;
    return part;
}

AxisLaw knownPart(const AxisLaw& law) {
    AxisLaw part = law;
    part.stiffness = part.damping = part.loss_factor = part.drift = 0;
    part.relaxation.reset();
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
    const auto axes = static_cast<Eigen::Index>(3 * model.connections.size());
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
            if (law.loss_factor != 0 || law.drift != 0 || law.relaxation) history.elastic_is_displacement = false;
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
