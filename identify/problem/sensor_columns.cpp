#include "identify/problem/sensor_columns.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;

constexpr double kDependent = 1e-10;  // relative size of a singular value of motions that channels do not show

/// The kind with the same transfer: a turn and a place change a channel by what it reads, as a gain does.
UnknownKind likeOf(UnknownKind kind) {
    return kind == UnknownKind::channel_delay || kind == UnknownKind::corner ? kind : UnknownKind::channel_gain;
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
        group.reading.resize(samples.channels.size(), run.sampleCount());
        for (Eigen::Index c = 0; c < group.reading.rows(); ++c)
            group.reading.row(c) = calcReading(layout.channels[samples.channels[c]], group);
        const Eigen::MatrixXd& folded = group.part == Part::mobile ? run.mobile_folded : run.fixed_folded;
        if (folded.size() > 0 && group.derivative == Derivative::displacement) samples.values -= group.design * folded;
        Eigen::MatrixXd residual = run.filter.apply(samples.values, 0) - group.reading;
        residual.colwise() -= residual.rowwise().mean().eval();
        group.residual = spectra.transform(residual);
        groups_.push_back(std::move(group));
    }
    changes_.resize(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (!isOfSensor(table[i].kind) || !(wanted.empty() || wanted[i] != 0)) continue;
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

Eigen::MatrixX3d SensorColumns::calcDerivatives(const Eigen::RowVectorXcd& spectrum, const Group& group,
                                                UnknownKind kind) const {
    Eigen::MatrixXcd all = spectrum.replicate<3, 1>();
    const double bin = kTwoPi / (fourier_.size() * run_.interval),
                 slowest = kTwoPi * kSlowestIntegrated * run_.band.lowest;
    const bool plain = group.derivative == Derivative::displacement && calcTransfer(kind, 1.0) == Complex(1.0);
    for (Eigen::Index k = 0; k < all.cols(); ++k) {
        const double w = bin * static_cast<double>(k);
        Complex factor = w > 0 ? calcTransfer(kind, w) * calcWeight(group, w) : Complex(1);
        if (w < slowest && !plain) factor = 0;
        all(0, k) *= factor;
        all(1, k) *= Complex(0, w) * factor;
        all(2, k) *= -w * w * factor;
    }
    return fourier_.inverse(all, run_.sampleCount()).transpose();
}

Eigen::RowVectorXd SensorColumns::calcReading(const SensorChannel& channel, const Group& group) const {
    const SmoothPart& part = group.part == Part::mobile ? run_.mobile : run_.fixed;
    Eigen::RowVectorXd reading(run_.sampleCount());
    for (Eigen::Index k = 0; k < reading.size(); ++k)
        reading[k] = calcChannelMotion(channel, group.derivative, part.R[k], part.p.col(k), part.w.col(k),
                                       part.a.col(k), part.alpha.col(k));
    return reading;
}

Eigen::RowVectorXd SensorColumns::calcSignal(const Unknown& row, const Group& group, Eigen::Index index,
                                             Vector6& from) const {
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
            signal = calcReading(across, group);
            break;
        }
        case UnknownKind::station_place: {
            if (channel.station != row.first) break;
            const Eigen::Vector3d lever = Eigen::Vector3d::Unit(row.second).cross(channel.direction);
            from << Eigen::Vector3d::Zero(), lever;
            // A reading is affine in the place.
            SensorChannel unit = channel, origin = channel;
            unit.position = Eigen::Vector3d::Unit(row.second);
            origin.position.setZero();
            signal = calcReading(unit, group) - calcReading(origin, group);
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

SensorEffect SensorColumns::calcEffect(std::size_t row) const {
    SensorEffect effect;
    const Unknown& unknown = table_[row];
    for (const Change& change : changes_[row]) {
        const Group& group = groups_[change.group];
        effect.part = group.part;
        SensorEffect::ChannelChange own{change.signal, group.inverse.col(change.channel),
                                        weights_.at({change.group, unknown.kind}),
                                        Eigen::VectorXcd(change.spectrum.size())};
        for (Eigen::Index b = 0; b < own.spectrum.size(); ++b)
            own.spectrum[b] = -calcWeight(group, spectra_.angular(b)) * change.spectrum[b];
        effect.changes.push_back(std::move(own));
    }
    for (const auto& [of, signals] : signals_) {
        if (of.second != likeOf(unknown.kind)) continue;
        const Matrix6 turn = calcMotionChange(row, of.first);
        if (!turn.isZero(0.0)) effect.groups.push_back({turn, signals});
    }
    if (second_.empty() || second_[row].size() == 0) return effect;
    const Eigen::MatrixXcd second = second_[row].cast<Complex>();
    effect.correction = Eigen::MatrixXcd::Zero(6, second.cols());
    Eigen::Index first = 0;
    for (const std::size_t g : findGroups(effect.part)) {
        const Group& group = groups_[g];
        const Eigen::MatrixXcd fused = group.inverse.cast<Complex>() * second.middleRows(first, group.design.rows());
        for (Eigen::Index b = 0; b < fused.cols(); ++b)
            effect.correction.col(b) -= calcWeight(group, spectra_.angular(b)) * fused.col(b);
        first += group.design.rows();
    }
    effect.wrench = second.bottomRows(12);
    return effect;
}

std::vector<std::size_t> SensorColumns::findGroups(Part part) const {
    std::vector<std::size_t> found;
    for (std::size_t g = 0; g < groups_.size(); ++g)
        if (groups_[g].part == part) found.push_back(g);
    return found;
}

SensorSignals SensorColumns::calcSignals(const Group& group, UnknownKind kind, const TurningWrench& wrench) const {
    const SmoothPart& part = group.part == Part::mobile ? run_.mobile : run_.fixed;
    const bool displacement = group.derivative == Derivative::displacement;
    Eigen::MatrixXd rows(6, run_.sampleCount());
    rows << (displacement ? part.p : part.a), (displacement ? part.theta : part.alpha);
    rows.colwise() -= rows.rowwise().mean().eval();
    const Eigen::MatrixXcd spectrum = fourier_.forward(rows);
    SensorSignals signals;
    for (auto& derivative : signals.samples) derivative.resize(run_.sampleCount(), 6);
    for (Eigen::Index m = 0; m < rows.rows(); ++m) {
        const Eigen::MatrixX3d own = calcDerivatives(spectrum.row(m), group, kind);
        for (Eigen::Index k = 0; k < 3; ++k) signals.samples[static_cast<std::size_t>(k)].col(m) = -own.col(k);
    }
    Eigen::MatrixXcd tapered = spectra_.transform(rows);
    for (Eigen::Index b = 0; b < tapered.cols(); ++b) {
        const double w = spectra_.angular(b);
        tapered.col(b) *= -calcWeight(group, w) * calcTransfer(kind, w);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        signals.edges[k] = spectra_.transformSamples(signals.samples[k]);
        for (Eigen::Index b = 0; b < tapered.cols(); ++b)
            signals.edges[k].col(b) -= std::pow(Complex(0, spectra_.angular(b)), static_cast<int>(k)) * tapered.col(b);
    }
    for (Eigen::Index b = 0; b < tapered.cols(); ++b) tapered.col(b) *= -std::pow(spectra_.angular(b), 2);
    if (wrench.modal_edges) signals.modal_edges = wrench.modal_edges(signals.samples[2], tapered);
    return signals;
}

TurningOutputs SensorColumns::makeOutputs(const std::vector<std::size_t>& groups, const TurningWrench& wrench) const {
    return [this, groups, &wrench](const TurningInstant& at) {
        std::vector<double> values;
        for (const std::size_t g : groups)
            for (const int channel : groups_[g].channels)
                values.push_back(calcChannelMotion(layout_.channels[channel], groups_[g].derivative, at.R, at.p, at.w,
                                                   at.a, at.alpha));
        Eigen::VectorXd all = Eigen::Map<Eigen::VectorXd>(values.data(), values.size());
        const Eigen::VectorXd own = wrench.outputs(at);
        all.conservativeResize(all.size() + own.size());
        all.tail(own.size()) = own;
        return all;
    };
}

Matrix6 SensorColumns::calcMotionChange(std::size_t row, std::size_t group) const {
    Matrix6 C = Matrix6::Zero();
    for (const Change& change : changes_[row])
        if (change.group == group) C += groups_[group].inverse.col(change.channel) * change.signal.transpose();
    return C;
}

void SensorColumns::addSecondOrder(const std::array<TurningWrench, 2>& wrenches) {
    constexpr UnknownKind kKinds[] = {UnknownKind::channel_gain, UnknownKind::channel_delay, UnknownKind::corner};
    second_.assign(table_.size(), {});
    for (const Part part : {Part::mobile, Part::fixed}) {
        const bool mobile = part == Part::mobile;
        const std::vector<std::size_t> groups = findGroups(part);
        const TurningWrench& wrench = wrenches.at(mobile ? 0 : 1);
        const TurningOutputs outputs = makeOutputs(groups, wrench);
        for (const std::size_t g : groups)
            for (const UnknownKind like : kKinds) {
                std::optional<SecondOrder> order;
                for (std::size_t i = 0; i < changes_.size(); ++i) {
                    if (likeOf(table_[i].kind) != like) continue;
                    const Matrix6 C = calcMotionChange(i, g);
                    if (C.isZero(0.0)) continue;
                    if (!order) {
                        const auto signals =
                            std::make_shared<const SensorSignals>(calcSignals(groups_[g], like, wrench));
                        signals_[{g, like}] = signals;
                        order.emplace(mobile ? run_.mobile : run_.fixed, mobile ? run_.fixed : run_.mobile,
                                      wrench.forces, signals->samples, spectra_, outputs);
                    }
                    const Eigen::MatrixXcf own = order->calc(C);
                    if (second_[i].size() == 0)
                        second_[i] = own;
                    else if (own.size() > 0)
                        second_[i] += own;
                }
            }
    }
}

}  // namespace wems::identify
