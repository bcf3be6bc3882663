/// @file
/// What the single-connection methods work on: displacement, velocity and force of one axis of one connection.
///
/// Signs as in the force law: q is the displacement of the mobile end relative to the fixed end, f the force that the
/// element opposes to it, so that f = +k q. A force channel is taken as it stands. Without one, f = −m a with a the
/// acceleration of the mobile end: exact where the connection is the only force on a mass m (an accelerometer on a
/// falling body does not see gravity: nothing is to be subtracted), and qualitative where other connections act too.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "models/recording/recording.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {

// Strokes between the reversals of a motion, and what dry friction and backlash leave in them.

/// Direction of travel at every sample, +1 or −1: that of the stroke it belongs to.
Eigen::VectorXd calcDirection(const Eigen::VectorXd& q, double fraction);

/// Travel since the last reversal at every sample, m; NaN before the first.
Eigen::VectorXd calcTravel(const Eigen::VectorXd& q, double fraction);

/// True at the samples of full strokes: between two reversals, at least 80 % as long as the longest such stroke.
std::vector<bool> findFullStrokes(const Eigen::VectorXd& q);

/// A median over strokes with its 95 % interval; the strokes are the independent repeats, so that whatever the samples
/// within a stroke have in common is in the interval.
struct StrokeStatistic {
    double value = 0;
    double lower = 0, upper = 0;  ///< infinite with fewer than two strokes
    std::vector<double> strokes;  ///< one value for each
};
StrokeStatistic summariseStrokes(std::vector<double> values);

/// What a dry-friction element with backlash shows.
struct StrokeSummary {
    StrokeStatistic positive_level;                          ///< N, force while sliding towards +q
    StrokeStatistic negative_level;                          ///< N, towards −q (negative)
    StrokeStatistic gap;                                     ///< m, all reversals
    StrokeStatistic gap_after_positive, gap_after_negative;  ///< m, after a stroke towards + or −
    double low_force = 0;                                    ///< N, |f| below this counts as gap
    double rise = 0;       ///< m, median travel from 1 to 3 low forces or back, on either side of the gap
    double stroke = 0;     ///< m, mean travel between reversals
    double loop_fill = 0;  ///< energy of a loop over that of the rectangle of its levels and stroke
    double flatness = 0;   ///< change of force over the second half of a stroke over the mean level
};

/// Levels: median force over the second half of each full stroke. Gap: travel between the
/// first and the last sample of a stroke with |f| below `low_force` (0: 5 % of the mean level).
StrokeSummary summariseFriction(const Eigen::VectorXd& q, const Eigen::VectorXd& force, double low_force = 0);

/// What to take out of a recording.
struct ComponentOptions {
    std::string connection;          ///< empty: the first that has what is needed
    std::optional<int> axis;         ///< 0 x, 1 y, 2 z; absent: the first recorded for the connection
    std::optional<double> mass;      ///< kg; given: force = −mass × acceleration even where a force is recorded
    std::optional<double> from, to;  ///< s, window; velocities are derived before it is cut out
    bool time_known = true;          ///< false: samples are only numbered, so that there is no velocity
    bool unit_mass_allowed = false;  ///< without force channel and mass: force per kilogram instead of an error
};

enum class ForceSource { recorded, mass_times_acceleration };

/// Samples of one axis; all arrays have the same length. Clipped samples are left out.
struct ComponentData {
    std::string file;
    std::string connection;
    int axis = 0;
    Eigen::VectorXd time;      ///< s
    Eigen::VectorXd q;         ///< m
    Eigen::VectorXd velocity;  ///< m/s; all zero where the recording has no time
    Eigen::VectorXd force;     ///< N (N/kg with unit mass)
    ForceSource source = ForceSource::recorded;
    double mass = 0;           ///< kg, with which accelerations were multiplied; 0 for a recorded force
    bool has_velocity = true;  ///< false: the recording has no time, only the direction of travel is known
    bool qualitative = false;  ///< other connections act on the same body: the shape is right, the numbers are not
    std::vector<std::string> notes;  ///< how each quantity came about

    Eigen::Index count() const { return q.size(); }
};

/// True if the recording is of one element on a test machine: a force channel, or a displacement recorded directly
/// between two ends (`relative.…`), which a recording of a whole mount does not have.
bool isComponentTest(const Recording& recording);

/// Takes one axis out of a recording and derives what is missing.
/// @throws InputError naming the channel that is missing, or a window that holds fewer than 20 samples.
ComponentData extractComponent(const Recording& recording, const ComponentOptions& options);

}  // namespace wems::identify
