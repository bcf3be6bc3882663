#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/problem/sensor_columns.hpp"

namespace wems::identify {

// With w_x, w_a the weights of displacements and accelerations in the fused motion, σ_x and σ_a = ω² σ the noises and P
// the projection on rigid motions, a channel's fused reading and the residuals share
//     E[residual · reading] ∝ P_cc (w_x σ_x² − w_a σ²) (w_a² / σ_x² + w_x² / σ²)
// which is zero where the weights are those of the noise. Where its spectrum is not white they are not.
Eigen::MatrixXd SensorColumns::calcGainSlopes(const std::vector<std::size_t>& groups, Eigen::Index size) const {
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(size, 1);
    const Group *displacement = nullptr, *acceleration = nullptr;
    for (const std::size_t g : groups)
        (groups_[g].derivative == Derivative::displacement ? displacement : acceleration) = &groups_[g];
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
    for (std::size_t i = 0; i < table_.size(); ++i) {
        if (table_[i].kind != UnknownKind::channel_gain) continue;
        for (const Group* group : {displacement, acceleration})
            for (std::size_t c = 0; c < group->channels.size(); ++c) {
                if (group->channels[c] != table_[i].first) continue;
                const Eigen::Index channel = c;
                const double own = group->design.row(channel).dot(group->inverse.col(channel));
                slopes(i, 0) = (group == displacement ? -2 : 2) * own * sum;
            }
    }
    return slopes;
}

// A unit error changes channel c of group h by s at a bin. With B_gh = H_g H_h⁺, the fused reading f_g of a
// displacement in group g (1, or −ω²) and the weight W_h of group h in the fused motion, the channels of group g leave
//
//     B_gh e_c f_g W_h s − δ_gh e_c s
//
// and beyond first order, with N_g what the moved motion reads there, −N_g + Σ_h B_gh f_g W_h N_h.
BlockInformation SensorColumns::calcInformation(Part part, Eigen::Index size) const {
    BlockInformation block;
    const std::vector<std::size_t> groups = findGroups(part);
    Eigen::Index rows = 0, rank = 0;
    for (const std::size_t g : groups) {
        rows += groups_[g].design.rows();
        rank = std::max(rank, groups_[g].rank);
    }
    if (rows <= rank) return block;
    const Eigen::Index bins = spectra_.binCount();
    std::vector<Eigen::Index> unknowns;
    for (std::size_t i = 0; i < changes_.size(); ++i)
        if (!changes_[i].empty() && groups_[changes_[i].front().group].part == part)
            unknowns.push_back(static_cast<Eigen::Index>(i));
    block.A = Eigen::MatrixXd::Zero(size, size);
    block.b = Eigen::VectorXd::Zero(size);
    block.count = static_cast<double>(2 * bins * (rows - rank));
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size());
    Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns.size());
    constexpr Eigen::Index kChunk = 64;  // bins: 4 MB of columns for 40 channels and 100 unknowns
    for (Eigen::Index from = 0; from < bins; from += kChunk) {
        const Eigen::Index count = std::min(kChunk, bins - from);
        Eigen::MatrixXd columns(2 * rows * count, unknowns.size());
        for (std::size_t u = 0; u < unknowns.size(); ++u)
            columns.col(static_cast<Eigen::Index>(u)) = calcColumn(groups, unknowns[u], rows, from, count);
        Eigen::MatrixXcd left(rows, count);
        Eigen::Index first = 0;
        for (const std::size_t g : groups) {
            const Eigen::Index channels = groups_[g].design.rows();
            left.middleRows(first, channels) = groups_[g].residual.middleCols(from, count);
            first += channels;
        }
        const Eigen::VectorXd residual = whiten(groups, left, from);
        A.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
        b.noalias() += columns.transpose() * residual;
        block.chi_squared += residual.squaredNorm();
    }
    A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
    block.A(unknowns, unknowns) = A;
    block.b(unknowns) = b;
    block.noise_levels = Eigen::VectorXd::Constant(1, block.chi_squared / block.count);
    block.noise_slopes = calcGainSlopes(groups, size) * block.noise_levels[0];
    return block;
}

Eigen::VectorXd SensorColumns::calcColumn(const std::vector<std::size_t>& groups, Eigen::Index unknown,
                                          Eigen::Index rows, Eigen::Index from, Eigen::Index count) const {
    // What the channels change by beside the motion.
    Eigen::MatrixXcd beyond = Eigen::MatrixXcd::Zero(rows, count);
    if (!second_.empty() && second_[unknown].size() > 0)
        beyond = second_[unknown].topRows(rows).middleCols(from, count).cast<std::complex<double>>();
    std::vector<Eigen::Index> firsts;
    Eigen::Index first = 0;
    for (const std::size_t g : groups) {
        for (const Change& change : changes_[unknown])
            if (change.group == g)
                beyond.row(first + change.channel) += change.spectrum.segment(from, count).transpose();
        firsts.push_back(first);
        first += groups_[g].design.rows();
    }
    Eigen::MatrixXcd motion = Eigen::MatrixXcd::Zero(6, count);  // as displacement
    for (std::size_t h = 0; h < groups.size(); ++h) {
        const Group& group = groups_[groups[h]];
        const Eigen::MatrixXcd own = group.inverse * beyond.middleRows(firsts[h], group.design.rows());
        for (Eigen::Index b = 0; b < count; ++b)
            motion.col(b) += calcWeight(group, spectra_.angular(from + b)) * own.col(b);
    }
    Eigen::MatrixXcd column = -beyond;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const Group& group = groups_[groups[g]];
        const bool displacement = group.derivative == Derivative::displacement;
        Eigen::MatrixXcd read = group.design * motion;
        for (Eigen::Index b = 0; b < count && !displacement; ++b)
            read.col(b) *= -spectra_.angular(from + b) * spectra_.angular(from + b);
        column.middleRows(firsts[g], group.design.rows()) += read;
    }
    return whiten(groups, column, from);
}

Eigen::VectorXd SensorColumns::whiten(const std::vector<std::size_t>& groups, Eigen::MatrixXcd& rows,
                                      Eigen::Index from) const {
    Eigen::Index first = 0;
    for (const std::size_t g : groups) {
        const Group& group = groups_[g];
        for (Eigen::Index b = 0; b < rows.cols(); ++b)
            rows.col(b).segment(first, group.design.rows()) *=
                std::sqrt(2 / (group.noise->at(spectra_.frequency(from + b)) * spectra_.noiseGain()));
        first += group.design.rows();
    }
    // Real and imaginary parts beside each other, as they lie.
    return Eigen::Map<const Eigen::VectorXd>(reinterpret_cast<const double*>(rows.data()), 2 * rows.size());
}

}  // namespace wems::identify
