/// @file
/// Devices that the runs so far leave possible: what a plan promises should hold for each of them.
///
/// The numbers of the model are a Gaussian with the model's tolerances (± two standard deviations) about what the model
/// says, updated by what the runs tell: with x̂ and C the estimate and covariance of the fit, T the tolerances'
/// variances and x₀ the model's values
///
///     mean x̂ + C (C + T)⁻¹ (x₀ − x̂),      covariance C − C (C + T)⁻¹ C
///
/// (Bar-Shalom, Li and Kirubarajan 2001, ch. 1.4: fusion of two estimates). A stop that no run reached keeps its
/// tolerance, but for clearances at which it would have been noticed.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "identify/fit/fit.hpp"

namespace wems::identify {

class PossibleDevices {
public:
    /// @param model as the user has it, with its tolerances
    PossibleDevices(const FitResult& now, const MountModel& model);

    /// One of them.
    MountModel draw(std::mt19937_64& random) const;

private:
    struct UnreachedStop {
        std::string clearance, stiffness;  ///< names
        double noticed = 0;                ///< m
    };

    const MountModel& model_;
    MountModel fitted_;
    std::vector<std::string> names_;
    Eigen::VectorXd mean_;
    Eigen::MatrixXd root_;  ///< root_ root_ᵀ is the covariance
    std::vector<UnreachedStop> unreached_;
};

}  // namespace wems::identify
