/// @file
/// Recordings to files: CSV, OpenSim .trc, .sto and .mot, by the file's extension.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "models/recording/recording.hpp"

namespace wems {

struct WriteOptions {
    int digits = 9;  ///< significant digits of values, 1 to 17; time has at least 12
    /// Rest positions in ground axes, m, by connection: .trc holds positions. A connection that is not here is at 0.
    std::map<std::string, Eigen::Vector3d> rest;
};

/// The file is complete or not there.
/// @returns one sentence for each thing that the format cannot hold
/// @throws InputError: the file cannot be written, a unit that is not known, nothing that the format can hold;
///         std::invalid_argument: a channel whose length is not that of time, a name that is no channel, a value that
///         is infinite.
std::vector<std::string> writeRecording(const Recording& recording, const std::string& file,
                                        const WriteOptions& options = {});

}  // namespace wems
