/// @file
/// How a device has been tested so far: what a further run of the same test can be expected to be.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/motion/motion.hpp"
#include "identify/plan/planned_run.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

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
