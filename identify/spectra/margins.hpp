/// @file
/// How far and how hard each connection was worked in a run, and what is left of its clearances.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// Resonances in a frequency response.

struct ResponsePeak {
    Eigen::Index bin = 0;
    double frequency = 0;      ///< Hz
    double amplitude = 0;      ///< |H|
    double damping_ratio = 0;  ///< from the half-power width, Δf/(2 f); NaN where a side does not fall by 3 dB first
};

/// Local maxima of |H| within [from, to] (Hz), largest first, that stand out: from each, |H| falls by 3 dB to at least
/// one side and by 1 dB to the other before it rises above it again. Frequency and amplitude by the parabola through
/// the three bins in log |H|.
std::vector<ResponsePeak> findPeaks(const Eigen::VectorXd& frequency, const Eigen::VectorXd& amplitude, double from,
                                    double to);

/// One axis of one connection.
struct ConnectionMargin {
    std::string name;                     ///< `4.z`
    double lowest = 0, highest = 0;       ///< m, relative displacement from rest
    double rms = 0;                       ///< m, about the mean
    std::optional<double> largest_force;  ///< N, of the model's law along the motion, static part included
    /// m, least distance to contact on each side; negative: pressed by so much. Absent: no such stop, or no model.
    std::optional<double> left_negative, left_positive;
};

struct Margins {
    std::vector<ConnectionMargin> connections;
    std::vector<std::string> notes;  ///< how the relative displacements were obtained, or why there are none
};

/// @param model null: plain differences of both ends, no forces and clearances
Margins findMargins(const Recording& recording, const MountModel* model);

}  // namespace wems::identify
