/// @file
/// What data cannot tell: parameters whose value is not known, which combinations of them are, and which motion would
/// separate them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "identify/fit/parameter_set.hpp"

namespace wems::identify {

/// A linear combination of parameters that is known although its members are not.
struct KnownCombination {
    std::vector<int> members;  ///< indices of parameters
    Eigen::VectorXd factors;   ///< of the members, in SI units
    std::string text;          ///< `1.x.stiffness + 2.x.stiffness`
};

/// Parameters coupled by directions that the data leave open.
struct OpenGroup {
    std::vector<int> members;
    std::vector<KnownCombination> known;
    std::string separate_by;
};

struct Identifiability {
    std::vector<bool> known;  ///< for each parameter
    std::vector<OpenGroup> groups;
};

/// `1.x.stiffness - 0.5 2.x.stiffness`; members whose factor is zero are left out.
std::string formatCombination(const std::vector<Parameter>& parameters, const std::vector<int>& members,
                              const Eigen::VectorXd& factors);

/// Largest relative standard error of a parameter that is reported as known: 10 %, of dashpots 20 %.
double calcTolerance(const Parameter& parameter);

/// @param parameters those of the regression
/// @param scale      their scales, see calcScale()
/// @param covariance of parameter / scale, model error included
/// @param calcHalfWidth of the 95 % interval of Σ a_j x_j, x_j = parameter / scale. A combination is known only if
///     this is below calcTolerance(): what rests on few contacts has a wide interval in spite of a small standard
///     error.
Identifiability findIdentifiable(const MountModel& model, const std::vector<Parameter>& parameters,
                                 const Eigen::VectorXd& scale, const Eigen::MatrixXd& covariance,
                                 const std::function<double(const Eigen::VectorXd&)>& calcHalfWidth);

/// The relative motion in which errors of these stiffnesses (or dashpots) with that covariance would show most.
std::string describeSeparatingMotion(const MountModel& model, const std::vector<Parameter>& parameters,
                                     const Eigen::MatrixXd& covariance);

// How well the equations determine each direction in the space of the parameters: their singular values.

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
