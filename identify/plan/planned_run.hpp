/// @file
/// A run that has not been made yet: what it is driven by, and what it is recorded with.
#pragma once

#include <Eigen/Core>
#include <string>

namespace wems::identify {

/// What a sweep drives.
enum class Excitation {
    load,  ///< force at the bracket's load point, or where the model has the load act
    base   ///< acceleration of the base
};

/// Kinds of channels on both parts.
struct SensorKinds {
    bool displacement = false, acceleration = false;
};

/// A logarithmic sine sweep of constant amplitude.
struct PlannedRun {
    Excitation excitation = Excitation::load;
    Eigen::Vector3d level = Eigen::Vector3d::Zero();  ///< amplitude, N or m/s²
    double from = 5, to = 50;                         ///< Hz; to < from sweeps downwards
    double octaves_per_minute = 4;
    double sample_rate = 1000;  ///< Hz
    SensorKinds sensors;

    /// s
    double duration() const;
};

/// `sweep up from 5 to 50 Hz at 4 octaves per minute (50 s), force z 200 N, recorded as displacements at 1000 Hz`
std::string describe(const PlannedRun& candidate);

/// The command line that simulates the run: `simulate mount.toml --sweep 5:50 --rate 4 --force z=200 …`.
/// @param model_file quoted for a shell where that is needed
std::string formatCommand(const PlannedRun& candidate, const std::string& model_file);

/// The largest number of `digits` significant digits that is not above `value` > 0: a level that a command line can
/// say and that keeps its limit.
double roundDown(double value, int digits);

}  // namespace wems::identify
