#include "identify/problem/sensor_columns.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;

constexpr double kDependent = 1e-10;  // relative size of a singular value of motions that channels do not show
// Of the lowest frequency, for central differences: the motion moves by a thousandth of itself, so that what is left
// out is a millionth of the column.
constexpr double kCornerStep = 1e-3;

bool isSensor(UnknownKind kind) {
    switch (kind) {
        case UnknownKind::channel_gain:
        case UnknownKind::channel_delay:
        case UnknownKind::triax_rotation:
        case UnknownKind::station_place:
        case UnknownKind::corner:
            return true;
        default:
            return false;
    }
}

/// What a unit error makes of a channel's spectrum beside its signal: a delay differentiates, AC coupling integrates.
Complex calcTransfer(UnknownKind kind, double w) {
    if (kind == UnknownKind::channel_delay) return {0, -w};
    if (kind == UnknownKind::corner) return {0, kTwoPi / w};
    return 1.0;
}

}  // namespace

SensorColumns::SensorColumns(const TestRun& test, const SensorLayout& layout, const OpenLoopRun& run,
                             const EquationSpectra& spectra, const MotionNoise& noise, const UnknownTable& table,
                             const std::vector<char>& wanted)
    : layout_(layout), run_(run), spectra_(spectra), noise_(noise), table_(table), fourier_(run.sampleCount()) {
    for (std::size_t g = 0; g < layout.groups.size(); ++g) {
        GroupSamples samples = collectGroup(test.recording, layout, static_cast<int>(g));
        if (samples.empty()) continue;
        Group group{layout.groups[g].part, layout.groups[g].derivative, samples.channels, {}, {}, {}, {},
                    &test.noise[g]};
        group.design = makeChannelDesign(layout, samples.channels);
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(group.design, Eigen::ComputeThinU | Eigen::ComputeThinV);
        const auto& values = svd.singularValues();
        group.rank = (values.array() > kDependent * values[0]).count();
        group.inverse = svd.matrixV().leftCols(group.rank) * values.head(group.rank).cwiseInverse().asDiagonal() *
                        svd.matrixU().leftCols(group.rank).transpose();
        const SmoothPart& part = group.part == Part::mobile ? run.mobile : run.fixed;
        group.reading.resize(samples.channels.size(), run.sampleCount());
        for (Eigen::Index k = 0; k < group.reading.cols(); ++k)
            for (Eigen::Index c = 0; c < group.reading.rows(); ++c)
                group.reading(c, k) =
                    calcChannelMotion(layout.channels[samples.channels[c]], group.derivative, part.R[k], part.p.col(k),
                                      part.w.col(k), part.a.col(k), part.alpha.col(k));
        const Eigen::MatrixXd& folded = group.part == Part::mobile ? run.mobile_folded : run.fixed_folded;
        if (folded.size() > 0 && group.derivative == Derivative::displacement) samples.values -= group.design * folded;
        Eigen::MatrixXd residual = run.filter.apply(samples.values, 0) - group.reading;
        residual.colwise() -= residual.rowwise().mean().eval();
        group.residual = spectra.transform(residual);
        groups_.push_back(std::move(group));
    }
    changes_.resize(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (!isSensor(table[i].kind) || !(wanted.empty() || wanted[i] != 0)) continue;
        changes_[i] = calcChanges(table[i]);
        for (const Change& change : changes_[i]) addWeight(change.group, table[i].kind);
    }
}

void SensorColumns::addWeight(std::size_t group, UnknownKind kind) {
    std::shared_ptr<const Eigen::VectorXcd>& weight = weights_[{group, kind}];
    if (weight) return;
    const bool displacement = groups_[group].derivative == Derivative::displacement;
    Eigen::VectorXcd values(spectra_.binCount());
    for (Eigen::Index b = 0; b < values.size(); ++b) {
        const double w = spectra_.angular(b);
        values[b] = calcWeight(groups_[group], w) * calcTransfer(kind, w) * (displacement ? 1.0 : -w * w);
    }
    weight = std::make_shared<const Eigen::VectorXcd>(std::move(values));
}

double SensorColumns::calcWeight(const Group& group, double w) const {
    const auto weights = noise_.weights(group.part, w);
    return group.derivative == Derivative::displacement ? weights.displacement : -weights.acceleration / (w * w);
}

Eigen::RowVectorXd SensorColumns::calcSeries(const Unknown& row, const Change& change) const {
    const Group& group = groups_[change.group];
    Vector6 from;
    Eigen::MatrixXcd all = fourier_.forward(calcSignal(row, group, change.channel, from));
    const double bin = kTwoPi / (fourier_.size() * run_.interval),
                 slowest = kTwoPi * kSlowestIntegrated * run_.band.lowest;
    const bool plain = group.derivative == Derivative::displacement && calcTransfer(row.kind, 1.0) == Complex(1.0);
    for (Eigen::Index k = 0; k < all.cols(); ++k) {
        const double w = bin * static_cast<double>(k);
        if (w < slowest && !plain)
            all(0, k) = 0;
        else if (w > 0)
            all(0, k) *= calcTransfer(row.kind, w) * calcWeight(group, w);
    }
    return fourier_.inverse(all, run_.sampleCount());
}

Eigen::RowVectorXd SensorColumns::calcSignal(const Unknown& row, const Group& group, Eigen::Index index,
                                             Vector6& from) const {
    const SmoothPart& part = group.part == Part::mobile ? run_.mobile : run_.fixed;
    const bool displacement = group.derivative == Derivative::displacement;
    const int number = group.channels[index];
    const auto& channel = layout_.channels[number];
    from = group.design.row(index).transpose();
    Eigen::RowVectorXd signal;
    switch (row.kind) {
        case UnknownKind::channel_gain:
        case UnknownKind::channel_delay:
            if (number == row.first) signal = group.reading.row(index);
            break;
        case UnknownKind::corner:
            if (!displacement && (group.part == Part::mobile ? 0 : 1) == row.first) signal = group.reading.row(index);
            break;
        case UnknownKind::triax_rotation: {
            if (channel.triax != row.first) break;
            // n · (e × x): the point's motion along n × e.
            SensorChannel across = channel;
            across.direction = channel.direction.cross(Eigen::Vector3d::Unit(row.second));
            if (across.direction.isZero(1e-12)) break;
            from << across.direction, across.position.cross(across.direction);
            signal.resize(run_.sampleCount());
            for (Eigen::Index k = 0; k < signal.size(); ++k)
                signal[k] = calcChannelMotion(across, group.derivative, part.R[k], part.p.col(k), part.w.col(k),
                                              part.a.col(k), part.alpha.col(k));
            break;
        }
        case UnknownKind::station_place: {
            if (channel.station != row.first) break;
            const Eigen::Vector3d lever = Eigen::Vector3d::Unit(row.second).cross(channel.direction);
            if (lever.isZero(1e-12)) break;
            from << Eigen::Vector3d::Zero(), lever;
            signal = lever.transpose() * (displacement ? part.theta : part.alpha);
            break;
        }
        default:
            break;
    }
    if (signal.size() > 0) signal.array() -= signal.mean();
    return signal;
}

std::vector<SensorColumns::Change> SensorColumns::calcChanges(const Unknown& row) const {
    std::vector<Change> changes;
    for (std::size_t g = 0; g < groups_.size(); ++g)
        for (Eigen::Index c = 0; c < groups_[g].design.rows(); ++c) {
            Vector6 from;
            const Eigen::RowVectorXd signal = calcSignal(row, groups_[g], c, from);
            if (signal.size() == 0 || signal.isZero(0.0)) continue;
            Eigen::VectorXcd spectrum = spectra_.transform(signal).transpose();
            for (Eigen::Index b = 0; b < spectrum.size(); ++b)
                spectrum[b] *= calcTransfer(row.kind, spectra_.angular(b));
            changes.push_back({g, c, std::move(spectrum), from});
        }
    return changes;
}

SensorEffect SensorColumns::calcEffect(std::size_t row, bool with_series) const {
    SensorEffect effect;
    const Unknown& unknown = table_[row];
    for (const Change& change : changes_[row]) {
        const Group& group = groups_[change.group];
        effect.part = group.part;
        SensorEffect::ChannelChange own{change.signal,
                                        group.inverse.col(change.channel),
                                        weights_.at({change.group, unknown.kind}),
                                        Eigen::VectorXcd(change.spectrum.size()),
                                        {}};
        for (Eigen::Index b = 0; b < own.spectrum.size(); ++b)
            own.spectrum[b] = -calcWeight(group, spectra_.angular(b)) * change.spectrum[b];
        if (with_series) own.series = -calcSeries(unknown, change);
        effect.changes.push_back(std::move(own));
    }
    return effect;
}

Eigen::MatrixXd SensorColumns::integrate(const Eigen::MatrixXd& rows, Part part, bool in_motion) const {
    Eigen::MatrixXcd spectrum = fourier_.forward(rows);
    const double bin = 1 / (fourier_.size() * run_.interval),
                 slowest = in_motion ? std::max(kSlowestIntegrated * run_.band.lowest, run_.lowest)
                                     : kSlowestIntegrated * run_.band.lowest;
    for (Eigen::Index k = 0; k < spectrum.cols(); ++k) {
        const double frequency = bin * static_cast<double>(k), w = kTwoPi * frequency;
        spectrum.col(k) *= frequency < slowest ? Complex(0)
                                               : calcTransfer(UnknownKind::corner, w) *
                                                     (in_motion ? noise_.weights(part, w).acceleration : 1.0);
    }
    return fourier_.inverse(spectrum, run_.sampleCount());
}

// The motion that the accelerometers give is integrated as they are, but each sits on a lever that turns with the part:
// ∫ α × R r is not (∫ α) × R r. To first order in the motion nothing of a corner would be left, and what is of second
// order are some hundred standard deviations of the noise.
std::vector<Eigen::MatrixXcd> SensorColumns::calcCornerChanges(const std::vector<std::size_t>& groups,
                                                               Part part) const {
    const SmoothPart& motion = part == Part::mobile ? run_.mobile : run_.fixed;
    const double step = kCornerStep * run_.band.lowest;
    const auto moved = [&](const Eigen::Matrix3Xd& rows) {
        return Eigen::Matrix3Xd(step * integrate(rows, part, true));
    };
    const Eigen::Matrix3Xd p = moved(motion.p), theta = moved(motion.theta), w = moved(motion.w), a = moved(motion.a),
                           alpha = moved(motion.alpha);
    std::vector<Eigen::MatrixXcd> changes;
    for (const std::size_t g : groups) {
        const Group& group = groups_[g];
        const Eigen::MatrixXd own = group.derivative == Derivative::acceleration
                                        ? integrate(group.reading, part, false)
                                        : Eigen::MatrixXd::Zero(group.reading.rows(), group.reading.cols());
        Eigen::MatrixXd beyond(own.rows(), own.cols());
        for (Eigen::Index k = 0; k < own.cols(); ++k) {
            const Eigen::Matrix3d ahead = rotationFromVector(motion.theta.col(k) + theta.col(k));
            const Eigen::Matrix3d behind = rotationFromVector(motion.theta.col(k) - theta.col(k));
            for (Eigen::Index c = 0; c < own.rows(); ++c) {
                const SensorChannel& channel = layout_.channels[group.channels[c]];
                const auto read = [&](const Eigen::Matrix3d& R, double sign) {
                    return calcChannelMotion(channel, group.derivative, R, motion.p.col(k) + sign * p.col(k),
                                             motion.w.col(k) + sign * w.col(k), motion.a.col(k) + sign * a.col(k),
                                             motion.alpha.col(k) + sign * alpha.col(k));
                };
                beyond(c, k) = own(c, k) - (read(ahead, 1) - read(behind, -1)) / (2 * step);
            }
        }
        beyond.colwise() -= beyond.rowwise().mean().eval();
        changes.push_back(spectra_.transform(beyond));
    }
    return changes;
}

}  // namespace wems::identify
