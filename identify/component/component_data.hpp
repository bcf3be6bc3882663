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

namespace wems::identify {

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
