/// @file
/// Relative displacement of every connection, the quantity that simulations are judged by.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Relative displacements from rest, uniformly sampled; row i belongs to names[i].
struct RelativeDisplacement {
    std::string file;
    std::vector<double> time;         ///< s
    std::vector<std::string> names;   ///< `4.z`
    Eigen::MatrixXd q;                ///< m
    bool from_accelerations = false;  ///< says nothing at low frequency, where accelerations hardly see the motion
    Eigen::VectorXd swept_frequency;  ///< Hz at each sample, NaN where unknown
    double lowest_frequency = 0;      ///< Hz, lowest excited frequency; 0 if unknown
    std::vector<std::string> notes;

    double interval() const { return (time.back() - time.front()) / static_cast<double>(time.size() - 1); }
};

/// Relative displacements (3 · connections, m) of the model's static equilibrium.
Eigen::VectorXd calcRestDisplacement(const MountModel& model);

/// The mobile part with positions that belong to those of the fixed part. Where only the fixed part's were integrated,
/// the table's slow motion would be in one and not in the other: there the difference of the accelerations is
/// integrated instead (translations exactly, rotations to first order), whose ends are at rest as the filter wants it.
PartMotion matchBand(const RunMotion& run, const MountModel& model);

/// The exact definition, in F axes, of the rigid motions of both parts; all axes of all connections of the model.
/// Swept frequency and lowest frequency are left to the caller.
RelativeDisplacement calcRelativeDisplacement(const RunMotion& run, const MountModel& model);
/// The same from a recording, with its swept frequency.
RelativeDisplacement calcRelativeDisplacement(const Recording& recording, const MountModel& model);

/// Without a model: the plain difference mobile − fixed of each axis of each connection that was recorded, which leaves
/// out the turning of the fixed part (second order in the motion). A recording without channels of the fixed part
/// gives the mobile part alone. Accelerations alone are integrated twice above 0.6 times the lowest excited frequency.
/// @throws InputError if there is no channel of the mobile part, or a counterpart of one is missing.
RelativeDisplacement calcRelativeDisplacement(const Recording& recording);

/// Leaves what lies above 0.9 times `lowest_frequency`, fading out to 0.6 times it (zero-phase), as comparisons with
/// accelerations do.
void removeSlowMotion(RelativeDisplacement& displacement, double lowest_frequency);

}  // namespace wems::identify
