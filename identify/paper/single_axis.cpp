#include "identify/paper/single_axis.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "identify/forward/relative_displacement.hpp"
#include "identify/motion/differentiation.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/part_motion.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

namespace {

/// Acceleration of the point `position` of the mobile part, samples × 3.
Eigen::MatrixXd calcPointAcceleration(const PartMotion& motion, const Eigen::Vector3d& position) {
    Eigen::MatrixXd a(motion.a.cols(), 3);
    for (Eigen::Index k = 0; k < motion.a.cols(); ++k) {
        const Eigen::Vector3d lever = rotationFromVector(motion.theta.col(k)) * position;
        const Eigen::Vector3d w = motion.w.col(k), alpha = motion.alpha.col(k);
        a.row(k) = (motion.a.col(k) + alpha.cross(lever) + w.cross(w.cross(lever))).transpose();
    }
    return a;
}

/// Every axis of every connection of the model has a channel in `set`.
bool isComplete(const ChannelSet& set, const MountModel& model) {
    const auto of_connection = [&](const MarkerChannel& channel) {
        return channel.index < static_cast<int>(model.connections.size()) && channel.isPlain();
    };
    return set.count() == 3 * static_cast<int>(model.connections.size()) && set.hasCompleteTriads() &&
           std::all_of(set.channels.begin(), set.channels.end(), of_connection);
}

}  // namespace

SingleAxisData collectSingleAxisData(const Recording& recording, const MountModel& model) {
    SingleAxisData data;
    const Recording uniform = makeUniform(recording, data.notes);
    const RunMotion motion = estimateMotion(uniform, model);
    data.notes.insert(data.notes.end(), motion.notes.begin(), motion.notes.end());
    data.hertz = findSweptFrequency(uniform).hertz;

    const ChannelSet mobile = collectChannels(uniform, model, Part::mobile, Derivative::displacement);
    const ChannelSet fixed = collectChannels(uniform, model, Part::fixed, Derivative::displacement);
    if (isComplete(mobile, model) && isComplete(fixed, model)) {
        data.q = (mobile.values - fixed.values).transpose();
    } else {
        data.q = calcRelativeDisplacement(motion, model).q.transpose();
    }
    data.v.resize(data.q.rows(), data.q.cols());
    for (Eigen::Index j = 0; j < data.q.cols(); ++j)
        data.v.col(j) = differentiate(data.q.col(j), motion.interval).first;

    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Connection& connection : model.connections)
        centre += connection.position / static_cast<double>(model.connections.size());
    const ChannelSet acceleration = collectChannels(uniform, model, Part::mobile, Derivative::acceleration);
    if (isComplete(acceleration, model)) {
        data.a_centre = Eigen::MatrixXd::Zero(data.q.rows(), 3);
        for (int i = 0; i < acceleration.count(); ++i)
            data.a_centre.col(acceleration.channels[i].axis) +=
                acceleration.values.row(i).transpose() / static_cast<double>(model.connections.size());
    } else {
        data.a_centre = calcPointAcceleration(motion.mobile, centre);
    }
    data.a_body = calcPointAcceleration(motion.mobile, model.body.center_of_gravity);
    return data;
}

namespace {

constexpr Eigen::Index least_contact = 5;  // samples in contact for a stop to take part

/// A column of the equation and what it belongs to. `stops` empty: the elastomer, or a dashpot if connection < 0.
struct Column {
    std::string name, unit;
    int connection = -1, axis = 0;
    std::vector<std::size_t> stops;
    double model_value = 0;
    Eigen::VectorXd values;
    double factor = 1;  ///< of the column in the regression
};

double penetrate(const Stop& stop, double offset, double q) {
    const double moved = q + offset;
    return stop.side == Side::positive ? std::max(0.0, moved - stop.clearance) : std::min(0.0, moved + stop.clearance);
}

class Columns {
public:
    Columns(const MountModel& model, const SingleAxisData& data, std::vector<Eigen::Index> samples)
        : model_(model), data_(data), samples_(std::move(samples)) {}

    std::vector<Column> make(const std::vector<int>& axes, const SingleAxisOptions& options) const {
        std::vector<Column> columns;
        for (const int axis : axes)
            for (int i = 0; i < connectionCount(); ++i)
                if (lawOf(i, axis).stiffness != 0) columns.push_back(makeElastomer(i, axis));
        if (options.stops)
            for (const int axis : axes)
                for (int i = 0; i < connectionCount(); ++i) appendStops(i, axis, columns);
        if (options.damping)
            for (const int axis : axes) columns.push_back(makeDashpot(axis));
        return columns;
    }

    Eigen::VectorXd displacement(int connection, int axis) const { return pick(data_.q.col(3L * connection + axis)); }

private:
    int connectionCount() const { return static_cast<int>(model_.connections.size()); }
    const AxisLaw& lawOf(int connection, int axis) const { return model_.connections[connection].axis.at(axis); }
    std::string nameOf(int connection, int axis) const {
        return model_.connections[connection].name + "." + "xyz"[axis];
    }
    Eigen::VectorXd pick(const Eigen::VectorXd& signal) const {
        Eigen::VectorXd picked(samples_.size());
        for (std::size_t k = 0; k < samples_.size(); ++k) picked(k) = signal(samples_[k]);
        return picked;
    }

    Column makeElastomer(int connection, int axis) const {
        return {nameOf(connection, axis) + ".stiffness", "N/m", connection, axis, {}, lawOf(connection, axis).stiffness,
                displacement(connection, axis)};
    }

    /// Both sides share one coefficient, as published.
    void appendStops(int connection, int axis, std::vector<Column>& columns) const {
        const AxisLaw& law = lawOf(connection, axis);
        if (law.stops.empty()) return;
        Column column{{}, "N/m", connection, axis, {}, 0, displacement(connection, axis)};
        for (double& q : column.values) {
            double sum = 0;
            for (const Stop& stop : law.stops) sum += penetrate(stop, law.offset, q);
            q = sum;
        }
        if ((column.values.array() != 0).count() < least_contact) return;
        for (std::size_t s = 0; s < law.stops.size(); ++s) {
            column.stops.push_back(s);
            column.model_value += law.stops[s].stiffness / static_cast<double>(law.stops.size());
        }
        const std::string side = law.stops.front().side == Side::positive ? "+" : "-";
        column.name = nameOf(connection, axis) + (law.stops.size() > 1 ? ".stops" : "." + side) + ".stiffness";
        columns.push_back(std::move(column));
    }

    Column makeDashpot(int axis) const {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(data_.v.rows()), travel = sum;
        double mean = 0;
        for (int i = 0; i < connectionCount(); ++i) {
            sum += data_.v.col(3L * i + axis);
            travel += data_.q.col(3L * i + axis).cwiseAbs();
            mean += lawOf(i, axis).damping / connectionCount();
        }
        Column column{std::string(1, "xyz"[axis]) + ".damping", "N s/m", -1, axis, {}, mean, pick(sum)};
        // In m like the other columns, so that truncation compares motions and not units.
        const double size = pick(travel).norm() / connectionCount();
        if (column.values.norm() > 0 && size > 0) column.factor = size / column.values.norm();
        return column;
    }

    const MountModel& model_;
    const SingleAxisData& data_;
    std::vector<Eigen::Index> samples_;
};

std::vector<Eigen::Index> selectSamples(const SingleAxisData& data, const SingleAxisOptions& options,
                                        const std::string& file) {
    std::vector<Eigen::Index> samples;
    const bool all = !(options.highest > 0);
    for (Eigen::Index k = 0; k < data.q.rows(); ++k)
        if (all || (data.hertz(k) >= options.lowest && data.hertz(k) <= options.highest)) samples.push_back(k);
    if (samples.size() < 100)
        throw InputError({file, 0, "window"}, std::to_string(samples.size()) + " samples are left",
                         "a window of swept frequency that holds at least 100 samples of a sine sweep");
    return samples;
}

bool isHeld(const Column& column, const SingleAxisOptions& options) {
    return options.hold_elastomers && column.connection >= 0 && column.stops.empty();
}

void setStiffness(MountModel& model, const Column& column, double value) {
    if (column.connection < 0) return;
    AxisLaw& law = model.connections[column.connection].axis.at(column.axis);
    if (column.stops.empty()) law.stiffness = value;
    for (const std::size_t s : column.stops) law.stops[s].stiffness = value;
}

}  // namespace

SingleAxisResult identifySingleAxis(const Recording& recording, const MountModel& model,
                                    const SingleAxisOptions& options) {
    const SingleAxisData data = collectSingleAxisData(recording, model);
    const std::vector<Eigen::Index> samples = selectSamples(data, options, recording.file);
    const Columns maker(model, data, samples);
    const std::vector<int> axes = options.candidates.empty() ? std::vector<int>{options.axis} : options.candidates;
    const std::vector<Column> columns = maker.make(axes, options);

    const Eigen::Index rows = samples.size();
    const Eigen::MatrixXd& a = options.point == AccelerationPoint::marker_centre ? data.a_centre : data.a_body;
    Eigen::VectorXd b(rows);
    for (Eigen::Index k = 0; k < rows; ++k) b(k) = -model.body.mass * a(samples[k], options.axis);
    Eigen::MatrixXd A(rows, 0);
    for (const Column& column : columns) {
        if (isHeld(column, options)) {
            b -= column.model_value * column.values;
            continue;
        }
        A.conservativeResize(Eigen::NoChange, A.cols() + 1);
        A.rightCols<1>() = column.factor * column.values;
    }
    if (A.cols() == 0)
        throw InputError({recording.file, 0, ""}, "no stop is reached and the elastomers are held: nothing to identify",
                         "a run at a higher level, or elastomers that are not held");

    const TruncatedSolution solution = solveTruncated(A, b, options.keep);
    SingleAxisResult result;
    result.model = model;
    result.notes = data.notes;
    result.singular_percent = solution.singular_percent;
    result.rank = solution.rank;
    result.residual_fraction = solution.residual_fraction;
    const Eigen::VectorXd residual = b - A * solution.x;
    // Elastomers first: their nonparametric force takes the stops of the same axis with it.
    Eigen::Index position = 0;
    for (const Column& column : columns) {
        SingleAxisTerm term{column.name, column.unit, column.model_value, column.model_value, 1, 1, false, {}, {}};
        const bool held = isHeld(column, options);
        if (!held) {
            term.value = column.factor * solution.x(position);
            term.confidence = solution.confidence(position);
            term.confidence_refitted = solution.confidence_refitted(position);
            ++position;
            setStiffness(result.model, column, term.value);
        }
        if (column.connection >= 0 && column.stops.empty()) {
            term.q = column.values;
            term.force = residual + term.value * column.values;
        } else if (column.connection >= 0) {
            for (SingleAxisTerm& elastomer : result.terms)
                if (elastomer.name == column.name.substr(0, column.name.find('.') + 2) + ".stiffness")
                    elastomer.force += term.value * column.values;
        }
        term.held = held;
        result.terms.push_back(std::move(term));
    }
    return result;
}

}  // namespace wems::identify
