/// @file
/// How a device has been tested so far: what a further run of the same test can be expected to be.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// A run that has not been made yet: what it is driven by, and what it is recorded with.

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

/// What no run may exceed. All > 0.
struct PlanLimits {
    double force = 0;         ///< N, amplitude of the load vector; 0: there is no such excitation
    double acceleration = 0;  ///< m/s², amplitude of the base; 0: likewise
    double displacement = 0;  ///< m, amplitude of the base
    double stroke = 0;        ///< m, relative displacement along any axis of any connection
};
/// What a user says of limits and sweeps; the rest follows from the recordings.
struct AskedSetup {
    std::optional<double> force, acceleration, displacement, stroke;  ///< as in PlanLimits
    std::optional<std::pair<double, double>> band;                    ///< Hz, ascending
    std::optional<double> octaves_per_minute;
};

/// RMS noise of one channel.
struct ChannelNoise {
    double displacement = 0;  ///< m
    double acceleration = 0;  ///< m/s²
};

struct TestSetup {
    double from = 5, to = 50;       ///< Hz, of the sweeps
    double octaves_per_minute = 4;  ///< of the sweeps
    double sample_rate = 1000;      ///< Hz
    SensorKinds mobile, fixed;
    ChannelNoise mobile_noise, fixed_noise;
    double base_noise = 0;    ///< m/s² RMS of a channel of the base
    bool has_base = false;    ///< the base's acceleration was recorded
    double gain_scatter = 0;  ///< standard deviation of a channel's gain; 0 where noise alone explains the channels
    /// Names of the channels of both parts; empty where sensors are not at the connections, which a plan then takes as
    /// if all connections had them.
    std::vector<std::string> channels;
    PlanLimits limits;
    std::vector<std::string> notes;  ///< where band, rate and limits come from

    SensorKinds kinds() const {
        return {mobile.displacement || fixed.displacement, mobile.acceleration || fixed.acceleration};
    }
};

/// Band and rate are those of the recorded sweeps (5 to 50 Hz and 4 octaves per minute where nothing swept). The limits
/// are, where nobody asked for others, the levels that the recordings reached; a stroke may also be a quarter beyond
/// the largest clearance of the model, so that stops can be told.
/// @param runs motions of the recordings, in the same order
/// @throws InputError if nothing in recordings and limits tells how the device could be driven, or no channel that a
/// plan knows was recorded.
TestSetup findTestSetup(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings,
                        const MountModel& model, const AskedSetup& asked);

}  // namespace wems::identify
