/// @file
/// The mount model: a rigid mobile part held by connections on a fixed part. Plain data; SI units; frames F (fixed
/// part) and M (mobile part) coincide at rest with the origin at the centre of the cross and z axial.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/axis_law.hpp"
#include "models/bracket.hpp"
#include "models/sensor_place.hpp"
#include "models/tolerances.hpp"

namespace wems {

// Which matrices are the inertia of a body.

/// Principal moments (kg m²), ascending.
Eigen::Vector3d calcPrincipalMoments(const Eigen::Matrix3d& inertia);

/// Moments of a body are positive, and none exceeds the sum of the other two: their differences from half the sum are
/// ∫x² dm, ∫y² dm, ∫z² dm along the principal axes.
/// @param principal ascending
/// @returns what is broken, in words that say what a body's are; empty if nothing is
std::string findInertiaProblem(const Eigen::Vector3d& principal);

/// `wanted` if a body has it, otherwise the point on the straight way to it from `believed` where bodies end, less a
/// hundredth of that way. Bodies' inertias form a convex cone, so that there is one such point, and a principal moment
/// is at least a hundredth of the smallest believed one. What `wanted` does not change stays as it is.
/// @param believed of a body @param wanted symmetric and finite
Eigen::Matrix3d limitInertia(const Eigen::Matrix3d& believed, const Eigen::Matrix3d& wanted);

class OutputFiles;

/// x y z rx ry rz, as a model file names the motions of the mobile part.
inline constexpr std::array<const char*, 6> kMotionNames{"x", "y", "z", "rx", "ry", "rz"};

/// The mobile part. All vectors in M.
struct MobileBody {
    double mass = 0;                                              ///< kg, > 0
    Eigen::Vector3d center_of_gravity = Eigen::Vector3d::Zero();  ///< p_MoBcm, m
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();            ///< about the CoG, kg m², positive definite
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();               ///< angular momentum of the wheel, N m s
    Tolerances tolerances = {};                                   ///< mass, center_of_gravity, inertia of this body
    /// Motions that it can make relative to F, in the order of kMotionNames; the others are held
    /// (models/guided_motion.hpp).
    std::array<bool, 6> free{true, true, true, true, true, true};
};

/// A connection: three independent axis laws along the mount axes (those of F).
struct Connection {
    std::string name;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, of both ends, each in its own frame, at rest
    std::array<AxisLaw, 3> axis;                         ///< x, y, z
    Tolerances tolerances = {};                          ///< position of this connection alone
    /// stiffness, damping, clearance, stop_stiffness of one axis alone: x, y, z.
    std::array<Tolerances, 3> axis_tolerances = {};
};

/// Applied load = gain(f) · axis_gain · recorded load; f the swept frequency (Hz). A single gain has one row with
/// frequency 0.
struct LoadCorrection {
    std::vector<std::pair<double, double>> gain_over_frequency;  ///< (Hz, -), frequencies ascending
    Eigen::Vector3d axis_gain = Eigen::Vector3d::Ones();         ///< of fx, fy, fz: each is measured by itself
};

/// Where the recorded load acts, if not at the bracket's load point.
struct LoadPoint {
    Part part = Part::mobile;                            ///< mobile or fixed
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, in that part's frame
};

/// What the recording's channel makes of the truth: measured(t) = gain · R(rotation) · true(t − delay) + zero.
struct SensorFault {
    std::string channel;  ///< `mobile.1.az`, or what holds it: `mobile.1.a`, `mobile.1`, `mobile`
    double gain = 1;
    double delay = 0;                                    ///< s
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rotation vector, rad
    double zero = 0;             ///< what it reads of nothing, in the channel's SI unit; of one channel alone
    Tolerances tolerances = {};  ///< sensor_gain, sensor_rotation, sensor_position, sensor_delay of these channels
};

struct MountModel {
    std::string name;
    Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< m/s², mount axes
    MobileBody body;
    std::vector<Connection> connections;
    std::string bracket_file;  ///< as written in the TOML; empty = none
    std::string bracket_path;  ///< where that file was found, from the working folder
    std::vector<BracketMode>
        bracket;  ///< replacements ([[bracket.mode]]) already applied; empty = F does not move by itself
    std::vector<int> replaced_modes;  ///< from 1: rows that [[bracket.mode]] replaced
    Tolerances tolerances;            ///< [tolerance]; models/model_tolerance.hpp tells which one holds for what
    std::optional<LoadCorrection> load;
    std::optional<LoadPoint> load_point;  ///< absent: the bracket's load point
    std::vector<SensorFault> sensors;
    std::vector<SensorPlace> places;  ///< sensors that are not at a connection along the mount axes

    /// Index of a connection by name; throws InputError naming those that exist.
    int connectionIndex(const std::string& connection_name) const;
    /// Index among `places` of the sensor that a channel names; -1 if it is none of them.
    int placeIndex(const ChannelName& channel) const;
};

/// Throws InputError (without a file) naming the key, the value and the range, if the model cannot be simulated.
void validate(const MountModel& model);

/// Reads a model from TOML (models/README in the repository documents every key). The bracket modes are read from the
/// file named there, beside the TOML. Throws InputError with file, line and key.
MountModel readMountModel(const std::string& file);
/// The same from text; `file` is for messages, and the bracket's modes are looked for beside it.
MountModel parseMountModel(std::string_view text, const std::string& file);

/// Writes the model as TOML that readMountModel reads back to the same model. A bracket file is referred to, relative
/// to the new file where possible; replaced modes are written as [[bracket.mode]]. Nothing is left behind on failure.
void writeMountModel(const MountModel& model, const std::string& file);
/// The same as one, or with modes two, of the files that a command writes.
void writeMountModel(const MountModel& model, const std::string& file, OutputFiles& outputs);

/// The same as text; `bracket_file` is written as the modes' path.
std::string formatMountModel(const MountModel& model, const std::string& bracket_file);

// Identified values as a model may hold them.

/// Brings what a fit put outside what a model allows back to its limit, since readMountModel() refuses what lies
/// beyond. Values below zero where there are none (stiffness, damping, loss factor, dissipation of a stop, level of
/// friction) become zero: as an estimate they say that the data do not show the thing, as a model they would feed the
/// motion with energy. An inertia that no body has is limited as limitInertia() says.
/// @param believed model that the fit began with, itself admissible
/// @returns one sentence for each value that was changed
std::vector<std::string> makeAdmissible(const MountModel& believed, MountModel& model);

}  // namespace wems
