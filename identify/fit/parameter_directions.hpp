/// @file
/// How well the equations determine each direction in the space of the parameters: their singular values.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/fit/parameter_set.hpp"

namespace wems::identify {

/// A direction of unit length, each parameter in units of its own size (calcScale()).
struct ParameterDirection {
    /// Of the weighted equations: by how many standard deviations of what is left they change, all of them together,
    /// per unit along the direction.
    double singular_value = 0;
    double relative_error = 0;  ///< standard error along it, model error included
    bool known = false;         ///< that error is below the tolerance of its largest member
    std::string text;           ///< its largest members: `0.71 1.x.stiffness - 0.71 2.x.stiffness`
};

/// By falling singular value.
/// @param information of parameter / scale: JᵀJ of the weighted equations
/// @param covariance  of parameter / scale, model error included
std::vector<ParameterDirection> findDirections(const std::vector<Parameter>& parameters,
                                               const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance);

}  // namespace wems::identify
