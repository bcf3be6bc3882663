/// @file
/// Command line of the executable simulate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plugin/drive.hpp"
#include "plugin/excitation_kinds.hpp"
#include "plugin/recorder.hpp"

namespace wems::plugin {

/// What the user asked for, checked as far as it can be without opening a file.
struct SimulateOptions {
    std::string model_file;
    std::string output_file, json_file, report_file;

    // A kind of excitation with its values, or a recording to replay.
    const ExcitationKind* kind = nullptr;  ///< nullptr if a recording is replayed
    std::string signal;                    ///< what the user gave to the option of `kind`
    std::string replay_file;               ///< empty otherwise
    std::string motion_file;               ///< relative motion that the laws follow; empty: a run

    // Questions that a model answers without a run.
    bool modes = false;  ///< natural modes and rest position
    std::string band;    ///< f0:f1 of transfer functions, Hz; empty: none
    bool isLinear() const { return modes || !band.empty(); }
    std::string response;       ///< f0:f1 of response curves, Hz; empty: none
    std::vector<Level> levels;  ///< of them
    int harmonics = 15;         ///< of them

    std::optional<double> octaves_per_minute, hertz_per_second;   ///< of a sweep; without both 4 octaves per minute
    bool downwards = false;                                       ///< of a profile
    std::optional<double> quality;                                ///< of the oscillators of a shock response spectrum
    double fade = 0;                                              ///< s, at start and end
    Eigen::Vector3d force = Eigen::Vector3d::Zero();              ///< N
    Eigen::Vector3d base_acceleration = Eigen::Vector3d::Zero();  ///< m/s²
    Eigen::Vector3d base_displacement = Eigen::Vector3d::Zero();  ///< m, of a sweep or dwell
    bool level_is_bare = false;                                   ///< an axis without a value, `z`
    bool level_has_unit = false;                                  ///< a value with a unit, `z=1.5g`
    std::optional<double> duration;                               ///< s, cuts the run
    std::string column_map;                                       ///< of the recording to replay

    std::optional<double> sample_rate;  ///< Hz; without it chosen, or the rows of the recording to replay
    double accuracy = 0;
    ChannelSelection channels;
    SensorNoise noise;
    std::uint64_t seed = 1;
    std::optional<double> time_limit;  ///< s; without it an hour, a minute where a stiff law makes the run slow
    bool quiet = false;
};

/// Reads the command line. Prints help where asked for, and then returns nothing.
/// @throws InputError: what cannot be used, and which help lists what is accepted
std::optional<SimulateOptions> readOptions(int argc, const char* const* argv);

/// The same for an executable.
/// @return options, or nullopt with `exit_status` if there is nothing to do: 0 after help, 2 after a usage error, which
/// is printed on one line of standard error.
std::optional<SimulateOptions> parseCommandLine(int argc, const char* const* argv, int& exit_status);

/// Excitation, output times and what to call it.
struct Excitation {
    std::shared_ptr<const Drive> drive;
    SampleTimes times;        ///< s from the start of the run
    double time_offset = 0;   ///< s, added in the output: a replay keeps the recording's time stamps
    std::string description;  ///< `sweep 5 to 50 Hz, 4 octaves per minute`
    std::string level;        ///< `force x=0 y=0 z=200 N`
};
/// Without a sampling rate from the user 1000 Hz, or five samples a period of the fastest that the excitation holds.
/// @throws InputError on values out of range or a recording that cannot be replayed.
/// @param sensors of the model: the zeros of load and base channels are no part of what a replay applies
Excitation makeExcitation(const SimulateOptions& options, const std::vector<SensorFault>& sensors);
/// The load and base motion of a recording, cut and sampled as the options say. @throws InputError if it has neither
Excitation makeReplay(Recording recording, const SimulateOptions& options, const std::vector<SensorFault>& sensors);

}  // namespace wems::plugin
