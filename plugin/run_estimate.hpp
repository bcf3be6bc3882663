/// @file
/// What a run will take, said before it begins.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "models/mount_model.hpp"

namespace wems::plugin {

/// The fastest thing that a model holds, as far as its numbers tell: what limits the integrator's step if it acts.
struct FastestLaw {
    std::string name;  ///< `1.z.damping`, `4.z.+.stiffness`, `bracket mode 3`
    double value = 0;  ///< of that parameter, SI
    double rate = 0;   ///< 1/s: natural frequency in rad/s, or inverse of a time constant
};
/// Each law against the mass that it moves: 1/m_e = 1/m + r²/I_min + Σ φ² of the bracket's modes.
FastestLaw findFastestLaw(const MountModel& model);

struct RunEstimate {
    double samples = 0, channels = 0;
    double steps = 0;         ///< at least; more where a law acts that is faster than the longest step
    double seconds = 0;       ///< of the steps, by what one took of devices of as many connections
    double file_bytes = 0;    ///< of the recording as text
    double memory_bytes = 0;  ///< beyond the program's own: the integrated base motion
};
/// @param duration, longest_step s
/// @param base_step s, of the integrated base motion; none: the base does not move
RunEstimate estimateRun(double samples, double channels, std::size_t connections, double duration, double longest_step,
                        std::optional<double> base_step);

/// True if the run is to be announced: more than a gigabyte, ten million steps or ten minutes.
bool isLong(const RunEstimate& estimate);

/// `100001 samples of 27 channels, a file of about 33 MB, 5 MB of memory for the base motion, 100000 steps or more,
/// about 15 s or more`
std::string describe(const RunEstimate& estimate);

/// @param file that the recording is written to; empty: none
/// @throws InputError if the folder of the file has less room than the recording takes
void checkDisk(const RunEstimate& estimate, const std::string& file);

/// @throws InputError if the run needs more memory than this computer has
void checkMemory(const RunEstimate& estimate);

}  // namespace wems::plugin
