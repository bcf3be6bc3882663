#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/problem/sensor_columns.hpp"

namespace wems::identify {

// A unit error changes channel c of group h by s at a bin. With B_gh = H_g H_h⁺, the fused reading f_g of a
// displacement in group g (1, or −ω²) and the weight W_h of group h in the fused motion, the channels of group g leave
//
//     B_gh e_c f_g W_h s − δ_gh e_c s
//
// so that the product of two columns is a sum of ∫ u s* s' with a few functions u of frequency, each times a number of
// the two channels: nothing needs the columns themselves.
/// Changes of a group's channels: real above imaginary parts, a column each.
struct SensorColumns::Members {
    std::vector<Eigen::Index> row, channel;
    Eigen::MatrixXd values;

    /// Of a change with a column whose dual is known.
    double calcProduct(std::size_t e, const Eigen::MatrixXcd& dual) const {
        const auto line = dual.row(channel[e]);
        const Eigen::Index bins = line.size(), column = e;
        return values.col(column).head(bins).dot(line.real().transpose()) +
               values.col(column).tail(bins).dot(line.imag().transpose());
    }
};

/// Of a part that has channels beyond its motions: how they hang together.
struct SensorColumns::Redundancy {
    using Spectra = std::vector<Eigen::MatrixXcd>;  // of each group, channels x bins

    std::vector<std::size_t> groups;
    std::vector<Eigen::VectorXd> precision;          // of a group's values at each bin, real and imaginary parts apart
    std::vector<std::vector<Eigen::VectorXd>> back;  // [g][h]: f_g W_h at each bin
    std::vector<std::vector<Eigen::MatrixXd>> B;     // [g][h]

    double calcProduct(const Spectra& a, const Spectra& b) const {
        double sum = 0;
        for (std::size_t g = 0; g < groups.size(); ++g)
            sum += a[g].cwiseProduct(b[g].conjugate()).real().colwise().sum().dot(precision[g]);
        return sum;
    }

    /// Z, with which Re Σ Z_c s* is the product of a column with the change s of channel c of a group.
    Eigen::MatrixXcd calcDual(const Spectra& column, std::size_t h) const {
        Eigen::MatrixXcd dual = -(column[h] * precision[h].asDiagonal());
        for (std::size_t g = 0; g < groups.size(); ++g)
            dual += B[g][h].transpose().cast<std::complex<double>>() *
                    (column[g] * precision[g].cwiseProduct(back[g][h]).asDiagonal());
        return dual;
    }

    /// Of each change of group h with each of group k.
    Eigen::MatrixXd calcProducts(const Members& a, std::size_t h, const Members& b, std::size_t k) const {
        const Eigen::Index rows = a.row.size(), cols = b.row.size();
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, cols);
        const auto add = [&](const Eigen::VectorXd& u, const Eigen::MatrixXd& factor) {
            const Eigen::MatrixXd common = a.values.transpose() * (u.replicate(2, 1).asDiagonal() * b.values);
            sum += common.cwiseProduct(factor(a.channel, b.channel));
        };
        for (std::size_t g = 0; g < groups.size(); ++g)
            add(precision[g].cwiseProduct(back[g][h]).cwiseProduct(back[g][k]), B[g][h].transpose() * B[g][k]);
        if (h == k) {
            add(precision[h].cwiseProduct(back[h][h]), -(B[h][h] + B[h][h].transpose()));
            add(precision[h], Eigen::MatrixXd::Identity(B[h][h].rows(), B[h][h].rows()));
        } else {
            add(precision[h].cwiseProduct(back[h][k]), -B[h][k]);
            add(precision[k].cwiseProduct(back[k][h]), -B[k][h].transpose());
        }
        return sum;
    }
};

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

BlockInformation SensorColumns::calcInformation(Part part, Eigen::Index size) const {
    BlockInformation block;
    Redundancy at;
    Eigen::Index rows = 0, rank = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (groups_[g].part != part) continue;
        at.groups.push_back(g);
        rows += groups_[g].design.rows();
        rank = std::max(rank, groups_[g].rank);
    }
    if (rows <= rank) return block;
    const Eigen::Index bins = spectra_.binCount();
    const std::size_t count = at.groups.size();
    for (const std::size_t g : at.groups) {
        Eigen::VectorXd precision(bins);
        for (Eigen::Index b = 0; b < bins; ++b)
            precision[b] = 2 / (groups_[g].noise->at(spectra_.frequency(b)) * spectra_.noiseGain());
        at.precision.push_back(std::move(precision));
        auto& back = at.back.emplace_back(count, Eigen::VectorXd(bins));
        auto& B = at.B.emplace_back();
        for (std::size_t h = 0; h < count; ++h) {
            const Group& other = groups_[at.groups[h]];
            for (Eigen::Index b = 0; b < bins; ++b) {
                const double w = spectra_.angular(b);
                const double reading = groups_[g].derivative == Derivative::displacement ? 1.0 : -w * w;
                back[h][b] = reading * calcWeight(other, w);
            }
            B.push_back(groups_[g].design * other.inverse);
        }
    }
    Redundancy::Spectra residual;
    for (const std::size_t g : at.groups) residual.push_back(groups_[g].residual);
    block.A = Eigen::MatrixXd::Zero(size, size);
    block.b = Eigen::VectorXd::Zero(size);
    block.chi_squared = at.calcProduct(residual, residual);
    block.count = static_cast<double>(2 * bins * (rows - rank));
    block.noise_levels = Eigen::VectorXd::Constant(1, block.chi_squared / block.count);
    block.noise_slopes = calcGainSlopes(at.groups, size) * block.noise_levels[0];

    addCorners(at, residual, part, block);
    std::vector<Members> members;
    for (const std::size_t g : at.groups) members.push_back(collectMembers(g));
    for (std::size_t h = 0; h < count; ++h) {
        const Members& own = members[h];
        const Eigen::MatrixXcd dual = at.calcDual(residual, h);
        for (std::size_t e = 0; e < own.row.size(); ++e) block.b[own.row[e]] += own.calcProduct(e, dual);
        for (std::size_t k = 0; k <= h; ++k) {
            const Eigen::MatrixXd common = at.calcProducts(own, h, members[k], k);
            for (std::size_t e = 0; e < own.row.size(); ++e)
                for (std::size_t f = 0; f < members[k].row.size(); ++f) {
                    block.A(own.row[e], members[k].row[f]) += common(e, f);
                    if (k < h) block.A(members[k].row[f], own.row[e]) += common(e, f);
                }
        }
    }
    return block;
}

/// AC coupling moves all channels of the part at once, beyond first order of the motion: a column as it is.
void SensorColumns::addCorners(const Redundancy& at, const std::vector<Eigen::MatrixXcd>& residual, Part part,
                               BlockInformation& block) const {
    const std::size_t count = at.groups.size();
    for (std::size_t i = 0; i < changes_.size(); ++i) {
        if (table_[i].kind != UnknownKind::corner || changes_[i].empty() ||
            groups_[changes_[i].front().group].part != part)
            continue;
        const Eigen::Index row = i;
        const std::vector<Eigen::MatrixXcd> beyond = calcCornerChanges(at.groups, part);
        Redundancy::Spectra column;
        for (std::size_t g = 0; g < count; ++g) {
            column.push_back(-beyond[g]);
            for (std::size_t h = 0; h < count; ++h)
                column[g] += at.B[g][h].cast<std::complex<double>>() * (beyond[h] * at.back[g][h].asDiagonal());
        }
        block.A(row, row) += at.calcProduct(column, column);
        block.b[row] += at.calcProduct(column, residual);
        for (std::size_t h = 0; h < count; ++h) {
            const Members others = collectMembers(at.groups[h]);
            const Eigen::MatrixXcd dual = at.calcDual(column, h);
            for (std::size_t e = 0; e < others.row.size(); ++e) {
                const double product = others.calcProduct(e, dual);
                block.A(row, others.row[e]) += product;
                block.A(others.row[e], row) += product;
            }
        }
    }
}

SensorColumns::Members SensorColumns::collectMembers(std::size_t group) const {
    Members members;
    std::vector<const Change*> changes;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
        if (table_[i].kind == UnknownKind::corner) continue;
        for (const Change& change : changes_[i]) {
            if (change.group != group) continue;
            members.row.push_back(static_cast<Eigen::Index>(i));
            members.channel.push_back(change.channel);
            changes.push_back(&change);
        }
    }
    const Eigen::Index bins = spectra_.binCount();
    members.values.resize(2 * bins, changes.size());
    for (std::size_t e = 0; e < changes.size(); ++e)
        members.values.col(e) << changes[e]->spectrum.real(), changes[e]->spectrum.imag();
    return members;
}

}  // namespace wems::identify
