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
constexpr double kBothParts = 1.4142135623730951;

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
                             const EquationSpectra& spectra, const MotionNoise& noise)
    : layout_(layout), run_(run), spectra_(spectra), noise_(noise), fourier_(run.sampleCount()) {
    const SmoothingKernel kernel = makeKernel(run.raw_interval, run.band);
    const int step = findDecimation(run.raw_interval, run.band);
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
        Eigen::MatrixXd residual = kernel.apply(samples.values, 0, step) - group.reading;
        residual.colwise() -= residual.rowwise().mean().eval();
        group.residual = spectra.transform(residual);
        groups_.push_back(std::move(group));
    }
}

Complex SensorColumns::calcWeight(const Group& group, double w) const {
    const auto weights = noise_.weights(group.part, w);
    return group.derivative == Derivative::displacement ? Complex(weights.displacement)
                                                        : Complex(-weights.acceleration / (w * w));
}

SensorColumns::Change SensorColumns::makeChange(const Group& group, Eigen::Index channel,
                                                const Eigen::RowVectorXd& signal, UnknownKind kind,
                                                bool with_series) const {
    Change change{&group, channel, spectra_.transform(signal), {}, Vector6::Zero()};
    for (Eigen::Index b = 0; b < change.spectrum.cols(); ++b)
        change.spectrum(0, b) *= calcTransfer(kind, spectra_.angular(b));
    if (!with_series) return change;
    Eigen::MatrixXcd all = fourier_.forward(signal);
    const double bin = kTwoPi / (fourier_.size() * run_.interval),
                 slowest = kTwoPi * kSlowestIntegrated * run_.band.lowest;
    const bool plain = group.derivative == Derivative::displacement && calcTransfer(kind, 1.0) == Complex(1.0);
    for (Eigen::Index k = 0; k < all.cols(); ++k) {
        const double w = bin * static_cast<double>(k);
        if (w < slowest && !plain)
            all(0, k) = 0;
        else if (w > 0)
            all(0, k) *= calcTransfer(kind, w) * calcWeight(group, w);
    }
    change.series = fourier_.inverse(all, run_.sampleCount());
    return change;
}

std::vector<SensorColumns::Change> SensorColumns::calcChanges(const Unknown& row, bool with_series) const {
    std::vector<Change> changes;
    for (const Group& group : groups_) {
        const SmoothPart& part = group.part == Part::mobile ? run_.mobile : run_.fixed;
        const bool displacement = group.derivative == Derivative::displacement;
        for (std::size_t c = 0; c < group.channels.size(); ++c) {
            const auto& channel = layout_.channels[group.channels[c]];
            const Eigen::Index index = c;
            Eigen::RowVectorXd signal;
            Vector6 from = group.design.row(index).transpose();
            switch (row.kind) {
                case UnknownKind::channel_gain:
                case UnknownKind::channel_delay:
                    if (group.channels[c] == row.first) signal = group.reading.row(index);
                    break;
                case UnknownKind::corner:
                    if (!displacement && (group.part == Part::mobile ? 0 : 1) == row.first)
                        signal = group.reading.row(index);
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
            if (signal.size() > 0 && !signal.isZero(0.0)) {
                signal.array() -= signal.mean();
                changes.push_back(makeChange(group, index, signal, row.kind, with_series));
                changes.back().signal = from;
            }
        }
    }
    return changes;
}

SensorEffect SensorColumns::calcEffect(const Unknown& row, bool with_series) const {
    SensorEffect effect;
    if (!isSensor(row.kind)) return effect;
    for (const Change& change : calcChanges(row, with_series)) {
        if (effect.spectra.size() == 0) {
            effect.spectra = Eigen::MatrixXcd::Zero(6, spectra_.binCount());
            if (with_series) effect.series = Eigen::MatrixXd::Zero(6, run_.sampleCount());
        }
        effect.part = change.group->part;
        const Vector6 direction = change.group->inverse.col(change.channel);
        SensorEffect::ChannelChange own{change.signal, direction, Eigen::VectorXcd(effect.spectra.cols())};
        const bool displacement = change.group->derivative == Derivative::displacement;
        for (Eigen::Index b = 0; b < effect.spectra.cols(); ++b) {
            const double w = spectra_.angular(b);
            const Complex weight = calcWeight(*change.group, w);
            effect.spectra.col(b) -= direction.cast<Complex>() * (weight * change.spectrum(0, b));
            own.weight[b] = weight * calcTransfer(row.kind, w) * (displacement ? 1.0 : -w * w);
        }
        effect.changes.push_back(std::move(own));
        if (with_series) effect.series -= direction * change.series;
    }
    return effect;
}

// With w_x, w_a the weights of displacements and accelerations in the fused motion, σ_x and σ_a = ω² σ the noises and P
// the projection on rigid motions, a channel's fused reading and the residuals share
//     E[residual · reading] ∝ P_cc (w_x σ_x² − w_a σ²) (w_a² / σ_x² + w_x² / σ²)
// which is zero where the weights are those of the noise. Where its spectrum is not white they are not.
Eigen::MatrixXd SensorColumns::calcGainSlopes(const std::vector<const Group*>& groups, const UnknownTable& table,
                                              Eigen::Index size) const {
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(size, 1);
    const Group *displacement = nullptr, *acceleration = nullptr;
    for (const Group* group : groups)
        (group->derivative == Derivative::displacement ? displacement : acceleration) = group;
    if (displacement == nullptr || acceleration == nullptr) return slopes;
    double sum = 0;
    for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
        const double w = spectra_.angular(b), f = spectra_.frequency(b);
        const auto weights = noise_.weights(displacement->part, w);
        const double x = displacement->noise->at(f), a = acceleration->noise->at(f) / (w * w * w * w);
        if (!(x > 0) || !(a > 0)) continue;
        sum += (weights.displacement * x - weights.acceleration * a) *
               (weights.acceleration * weights.acceleration / x + weights.displacement * weights.displacement / a);
    }
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (table[i].kind != UnknownKind::channel_gain) continue;
        for (const Group* group : {displacement, acceleration})
            for (std::size_t c = 0; c < group->channels.size(); ++c) {
                if (group->channels[c] != table[i].first) continue;
                const Eigen::Index channel = c;
                const double own = group->design.row(channel).dot(group->inverse.col(channel));
                slopes(i, 0) = (group == displacement ? -2 : 2) * own * sum;
            }
    }
    return slopes;
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
std::vector<Eigen::MatrixXcd> SensorColumns::calcCornerChanges(const std::vector<const Group*>& groups,
                                                               Part part) const {
    const SmoothPart& motion = part == Part::mobile ? run_.mobile : run_.fixed;
    const double step = kCornerStep * run_.band.lowest;
    const auto moved = [&](const Eigen::Matrix3Xd& rows) {
        return Eigen::Matrix3Xd(step * integrate(rows, part, true));
    };
    const Eigen::Matrix3Xd p = moved(motion.p), theta = moved(motion.theta), w = moved(motion.w), a = moved(motion.a),
                           alpha = moved(motion.alpha);
    std::vector<Eigen::MatrixXcd> changes;
    for (const Group* group : groups) {
        const Eigen::MatrixXd own = group->derivative == Derivative::acceleration
                                        ? integrate(group->reading, part, false)
                                        : Eigen::MatrixXd::Zero(group->reading.rows(), group->reading.cols());
        Eigen::MatrixXd beyond(own.rows(), own.cols());
        for (Eigen::Index k = 0; k < own.cols(); ++k) {
            const Eigen::Matrix3d ahead = rotationFromVector(motion.theta.col(k) + theta.col(k));
            const Eigen::Matrix3d behind = rotationFromVector(motion.theta.col(k) - theta.col(k));
            for (Eigen::Index c = 0; c < own.rows(); ++c) {
                const SensorChannel& channel = layout_.channels[group->channels[c]];
                const auto read = [&](const Eigen::Matrix3d& R, double sign) {
                    return calcChannelMotion(channel, group->derivative, R, motion.p.col(k) + sign * p.col(k),
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

BlockInformation SensorColumns::calcInformation(Part part, const UnknownTable& table, const std::vector<char>& wanted,
                                                Eigen::Index size) const {
    BlockInformation block;
    Eigen::Index rows = 0, rank = 0;
    std::vector<const Group*> groups;
    for (const Group& group : groups_) {
        if (group.part != part) continue;
        groups.push_back(&group);
        rows += static_cast<Eigen::Index>(group.channels.size());
        rank = std::max(rank, group.rank);
    }
    if (rows <= rank) return block;
    const Eigen::Index bins = spectra_.binCount();
    // Whitened values: channels x bins, then real and imaginary parts.
    std::vector<Eigen::Index> first;
    std::vector<Eigen::RowVectorXd> weight;  // of each group's channels at each bin
    std::vector<Eigen::RowVectorXcd> fused;  // what of a channel's reading the fused motion gives back to it
    Eigen::Index filled = 0;
    for (const Group* group : groups) {
        first.push_back(filled);
        filled += static_cast<Eigen::Index>(group->channels.size());
        weight.emplace_back(bins);
        fused.emplace_back(bins);
        for (Eigen::Index b = 0; b < bins; ++b) {
            const double w = spectra_.angular(b);
            weight.back()[b] = kBothParts / std::sqrt(group->noise->at(spectra_.frequency(b)) * spectra_.noiseGain());
            fused.back()[b] = group->derivative == Derivative::displacement ? 1.0 : -w * w;
        }
    }
    const auto unfold = [](const Eigen::MatrixXcd& white) {
        Eigen::VectorXd values(2 * white.size());
        values.head(white.size()) = white.real().reshaped();
        values.tail(white.size()) = white.imag().reshaped();
        return values;
    };
    Eigen::MatrixXcd white(rows, bins);
    for (std::size_t g = 0; g < groups.size(); ++g)
        white.middleRows(first[g], groups[g]->residual.rows()) = groups[g]->residual * weight[g].asDiagonal();
    const Eigen::VectorXd residual = unfold(white);
    std::vector<Eigen::Index> used;
    std::vector<Eigen::VectorXf> columns;
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (!isSensor(table[i].kind) || !(i >= wanted.size() || wanted[i] != 0)) continue;
        const auto changes = calcChanges(table[i], false);
        if (changes.empty() || changes.front().group->part != part) continue;
        white.setZero();
        if (table[i].kind == UnknownKind::corner) {
            const auto beyond = calcCornerChanges(groups, part);
            for (std::size_t h = 0; h < groups.size(); ++h) {
                Eigen::MatrixXcd moved = beyond[h];
                for (Eigen::Index b = 0; b < bins; ++b) moved.col(b) *= calcWeight(*groups[h], spectra_.angular(b));
                for (std::size_t g = 0; g < groups.size(); ++g)
                    white.middleRows(first[g], groups[g]->design.rows()) +=
                        (groups[g]->design * groups[h]->inverse).cast<Complex>() * moved * fused[g].asDiagonal();
                white.middleRows(first[h], beyond[h].rows()) -= beyond[h];
            }
        } else {
            for (const Change& change : changes) {
                Eigen::RowVectorXcd moved = change.spectrum;
                for (Eigen::Index b = 0; b < bins; ++b) moved[b] *= calcWeight(*change.group, spectra_.angular(b));
                for (std::size_t g = 0; g < groups.size(); ++g) {
                    const Group& group = *groups[g];
                    const Eigen::VectorXcd back =
                        (group.design * change.group->inverse.col(change.channel)).cast<Complex>();
                    white.middleRows(first[g], back.size()).noalias() += back * moved.cwiseProduct(fused[g]);
                    if (change.group == &group) white.row(first[g] + change.channel) -= change.spectrum;
                }
            }
        }
        for (std::size_t g = 0; g < groups.size(); ++g) {
            auto own = white.middleRows(first[g], groups[g]->residual.rows());
            own = (own * weight[g].asDiagonal()).eval();
        }
        used.push_back(i);
        columns.push_back(unfold(white).cast<float>());
    }
    Eigen::MatrixXd J(residual.size(), columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) J.col(c) = columns[c].cast<double>();
    block.A = Eigen::MatrixXd::Zero(size, size);
    block.b = Eigen::VectorXd::Zero(size);
    block.noise_slopes = calcGainSlopes(groups, table, size);
    if (!used.empty()) {
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(J.cols(), J.cols());
        A.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose());
        A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
        block.A(used, used) = A;
        block.b(used) = J.transpose() * residual;
    }
    block.chi_squared = residual.squaredNorm();
    block.count = static_cast<double>(2 * bins * (rows - rank));
    if (block.count > 0) block.noise_slopes *= block.chi_squared / block.count;
    return block;
}

}  // namespace wems::identify
