/// @file
/// Parameters that a fit leaves open, as its answer tells them: each known combination, what no combination holds, and
/// a model in which the combinations are met.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/fit/identifiability.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

std::array<double, 2> makeInterval(double value, double half_width);

/// The parameters of a fit and their values.
struct SolvedParameters {
    const std::vector<Parameter>& parameters;
    const Eigen::VectorXd& scale;  ///< of each, > 0
    const MountModel &believed, &fitted;
    double least_error =
        0;  ///< of a combination, over the sum of its terms' magnitudes: what the equations are good to
    /// Half width of the 95 % interval of Σ a_j x_j, x_j = parameter / scale.
    std::function<double(const Eigen::VectorXd&)> calcHalfWidth;
};

/// Adds the groups to `not_identifiable`, and moves their members in `model`, each in proportion to its believed value,
/// until the known combinations hold.
void addOpenGroups(const SolvedParameters& solved, const Identifiability& identifiability, FitResult& result);

}  // namespace wems::identify
