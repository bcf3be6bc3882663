/// @file
/// A restoring force over relative displacement and velocity, as a report shows it in three dimensions.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace wems {

/// One force over the common cells, in the unit of the picture's label.
struct ForceSheet {
    std::string name;
    Eigen::MatrixXd force;  ///< displacements x velocities; NaN leaves a hole
    bool points = false;    ///< a point for each cell in place of a sheet
    int color = 0;          ///< place in the palette of the plots
};

struct ForceSurface {
    std::string title;
    std::string displacement_label, velocity_label, force_label;  ///< with units
    Eigen::VectorXd displacement, velocity;                       ///< middles of the cells, ascending
    std::vector<ForceSheet> sheets;
};

/// The surface as a JavaScript object.
std::string formatSurface(const ForceSurface& surface);

}  // namespace wems
