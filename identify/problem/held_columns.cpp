#include "identify/problem/held_columns.hpp"

#include "identify/problem/linearised_run.hpp"
#include "identify/problem/lineariser.hpp"

namespace wems::identify {
namespace {

/// b of the mount's or the bracket's columns.
Eigen::VectorXd project(const KeptColumns& kept, Block block, const Lineariser& at) {
    if (block == Block::mount) return kept.mount.project(unfold(at.residual().topRows(6)));
    const Eigen::VectorXd all = kept.bracket.project(unfold(at.residual().bottomRows(6)));
    const Eigen::Index own = kept.transients.cols(), others = all.size() - own;
    if (own == 0) return all;
    return all.head(others) - kept.transients * all.tail(own);
}

}  // namespace

std::optional<LinearisedRun> holdColumns(const LinearisedRun& from, const Eigen::VectorXd& moved, const Lineariser& at,
                                         const Information& misfit) {
    if (!from.kept || from.frequency.size() != at.spectra().binCount() ||
        from.frequency[0] != at.spectra().frequency(0))
        return std::nullopt;
    LinearisedRun result = from;
    result.mount_residual = at.residual().topRows(6);
    for (const Block block : {Block::mount, Block::bracket, Block::mobile_sensors, Block::fixed_sensors}) {
        BlockInformation& own = result.information[indexOf(block)];
        if (own.empty()) continue;
        const bool bends = block == Block::mount || block == Block::bracket;
        // What a channel shows beyond the rigid motion is linear in its errors.
        own.b = bends ? project(*from.kept, block, at).head(moved.size()).eval() : own.b + own.A * moved;
        const double now = misfit[indexOf(block)].chi_squared, left = now / own.chi_squared;
        own.chi_squared = now;
        own.noise_slopes *= left;
        own.noise_levels *= left;
        if (own.noise.size() > 0) {
            if (own.noise_right.size() == 0) own.noise_right = Eigen::VectorXd::Zero(moved.size());
            own.noise_right -= own.noise * moved;
        }
        own.growth = calcGrowth(own);
    }
    return result;
}

}  // namespace wems::identify
