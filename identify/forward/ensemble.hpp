/// @file
/// Many parameter sets of one model simulated under one drive: prediction bands, finite differences, campaigns.
///
/// Sets of equal structure (the same stops, branches, frictions and modes; other numbers) run side by side in the lanes
/// of the processor's vector unit, each with its own contacts. The results are those of ForwardModel up to rounding.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "identify/forward/forward_model.hpp"

namespace wems::identify {

class ForwardEnsemble {
public:
    explicit ForwardEnsemble(const std::vector<MountModel>& models);

    std::size_t size() const { return members_.size(); }
    const ForwardModel& member(std::size_t index) const { return *members_[index]; }

    /// Relative displacements of each set (Simulation::q) at all samples of the drive, from rest; an empty matrix where
    /// the motion grew beyond all bounds.
    std::vector<Eigen::MatrixXd> simulate(const Drive& drive) const;
    /// The same for `sample_count` samples from `first_sample` on, from one state for each set.
    std::vector<Eigen::MatrixXd> simulate(const Drive& drive, const std::vector<ForwardState>& initial,
                                          int first_sample, int sample_count) const;

private:
    std::vector<std::unique_ptr<ForwardModel>> members_;
    std::vector<std::vector<std::size_t>> groups_;  // of equal structure
};

}  // namespace wems::identify
