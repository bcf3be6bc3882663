/// @file
/// A mode that the bracket has and the modes file lacks, sought in what the bracket's equation leaves.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identify/problem/linearised_run.hpp"
#include "identify/problem/unknown.hpp"
#include "identify/solve/evidence.hpp"

namespace wems::identify {

struct MissingMode {
    BracketMode mode;
    /// By which the mode's participation of the load follows from its translation and rotation, as that of the model's
    /// modes does; nothing where it is a number of its own.
    std::optional<Eigen::Matrix<double, 3, 6>> load_by_shape;
    /// How far that of the model's modes lies from it, RMS of each direction.
    Eigen::Vector3d load_scatter = Eigen::Vector3d::Zero();
};

/// The mode that takes most away; nothing where no run has a bracket's equation, or no mode takes anything away.
///
/// Where the load point of all the model's modes moves rigidly with the interface, that of the new one does; otherwise
/// its participation in each direction of the load is sought too, as is that of each direction in which the base was
/// driven. Directions in which nothing acted are not determined.
std::optional<MissingMode> findMissingMode(const std::vector<TestRun>& runs, const SensorLayout& layout,
                                           const TestState& state);

/// How far a number of a mode may lie from where it was found.
double calcModeReach(const BracketMode& mode, const Unknown& row);

/// How a number of a missing mode may move, and what moves along.
/// @param index of its row; rows of a mode's shape follow each other
Direction makeModeDirection(const MissingMode& missing, const Unknown& row, int index);

}  // namespace wems::identify
