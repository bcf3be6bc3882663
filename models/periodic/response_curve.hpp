/// @file
/// Periodic responses of the device over frequency at one level: every branch of the curve, its folds, which parts are
/// stable, which stops are touched.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "models/periodic/harmonic_balance.hpp"

namespace wems {

struct ResponseSettings {
    double from = 0, to = 0;  ///< Hz
    int harmonics = 15;
    bool stability = true;
    std::function<void(double frequency, int points)> progress;  ///< may be empty
    bool detached = true;  ///< look for curves that are not connected with the low end of the band
};

/// Rows of the matrices: 3 · connections, x y z of each, displacement from rest, F axes.
struct ResponsePoint {
    double frequency = 0;             ///< Hz
    Eigen::VectorXd amplitude;        ///< m, half of what lies between the ends of the motion
    Eigen::VectorXd first;            ///< m, amplitude of the fundamental
    Eigen::VectorXd highest, lowest;  ///< m
    Instability instability = Instability::none;
    double largest_multiplier = 0;    ///< |μ| of the first Floquet multiplier
    std::vector<double> penetration;  ///< m, of each stop in the order of the model, 0: not touched
    bool touchesStop() const;
};

struct ResponseFold {
    double frequency = 0;       ///< Hz, where the curve turns back
    Eigen::VectorXd amplitude;  ///< m, as above, at the nearest point
};

/// Where stability changes.
struct ResponseBifurcation {
    double frequency = 0;  ///< Hz, where the largest multiplier passes the unit circle, between two points
    Instability kind = Instability::none;
};

struct ResponseCurve {
    std::vector<ResponsePoint> points;  ///< along the curve
    std::vector<ResponseFold> folds;
    std::vector<ResponseBifurcation> bifurcations;  ///< none where stability is not asked for
    std::string incomplete;  ///< why the curve ends before it has crossed the band; empty if it has
    int harmonics = 0;
    double seconds = 0;  ///< of processor time
    /// Curves that are not connected with this one within the band (continuation.hpp says which are found).
    std::vector<ResponseCurve> detached;
};

/// Follows the curve from the lower end of the band to where it leaves it, then looks for detached ones.
/// @throws InputError as PeriodicSystem, or if the settings cannot be used
ResponseCurve calcResponseCurve(const MountModel& model, const HarmonicInput& input, const ResponseSettings& settings);

}  // namespace wems
