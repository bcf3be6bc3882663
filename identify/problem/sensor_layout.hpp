/// @file
/// The sensors of the recordings of one test, and what each of them may have wrong.
///
/// A sensor's channel measures, to first order in what is wrong,
///
///     measured(t) = (1 + g) n · [ x(t − τ) + ρ × x ] + n · (θ × δ)        x the motion of its point, n its direction
///
/// with gain 1 + g, delay τ, rotation vector ρ of its triax and error of place δ; for an accelerometer δ turns with the
/// angular acceleration in the place of the rotation θ. Accelerometers of a part share one first-order high pass (AC
/// coupling) with corner f_c: measured = true / (1 − i f_c / f).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Channels of one part and one derivative (displacement or acceleration).
struct SensorGroup {
    Part part = Part::mobile;
    Derivative derivative = Derivative::displacement;
    std::vector<int> channels;  ///< indices into SensorLayout::channels
};

struct SensorChannel {
    std::string name;  ///< `mobile.1.az`
    int group = 0;
    int triax = 0;                                                              ///< index into SensorLayout::triaxes
    int station = 0;                                                            ///< index into SensorLayout::stations
    Eigen::Vector3d position = Eigen::Vector3d::Zero();                         ///< m, in its part's frame
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();                       ///< at rest
    int connection = -1;                                                        ///< where it sits; -1: at none
    bool turning = false;                                                       ///< the direction turns with the part
    Eigen::Matrix<double, 6, 1> freedom = Eigen::Matrix<double, 6, 1>::Ones();  ///< of its part (calcFreedom)
};

struct SensorTriax {
    std::string name;  ///< `mobile.1` (displacements) or `mobile.1.a` (accelerations)
    int group = 0;
};

struct SensorLayout {
    std::vector<SensorGroup> groups;
    std::vector<SensorChannel> channels;
    std::vector<SensorTriax> triaxes;
    std::vector<std::string> stations;  ///< `mobile.1`, `mobile.1.a`: where each triax sits

    /// -1 if there is none.
    int findChannel(const std::string& name) const;
    bool hasAccelerations(Part part) const;
};

/// All channels of the mobile and the fixed part that occur in any of the recordings.
SensorLayout makeSensorLayout(const std::vector<Recording>& recordings, const MountModel& model);

/// What the sensors have wrong: all zero for exact ones.
struct SensorErrors {
    explicit SensorErrors(const SensorLayout& layout);
    Eigen::VectorXd gain;                  ///< g of each channel
    Eigen::VectorXd delay;                 ///< s, of each channel
    Eigen::Matrix3Xd rotation;             ///< rad, of each triax
    Eigen::Matrix3Xd place;                ///< m, of each station
    std::array<double, 2> corner{{0, 0}};  ///< Hz, of the accelerometers of the mobile and of the fixed part

    bool isZero() const;
    bool operator==(const SensorErrors& other) const;
};

/// Of the lowest excited frequency, below which nothing is integrated: half of where displacements from accelerations
/// count from (0.6), so that the edge lies outside what is used.
inline constexpr double kSlowestIntegrated = 0.3;

/// The recording without its sensors' gains, delays, AC coupling and, of complete triads, directions.
/// @param recording uniformly sampled
/// @param lowest excited frequency, Hz: what AC coupling takes is given back from kSlowestIntegrated of it upwards
Recording correctSensors(const Recording& recording, const SensorLayout& layout, const SensorErrors& errors,
                         double lowest);

/// Takes off what errors of place, and of the direction of incomplete triads, make of each reading.
/// @param[in,out] recording of correctSensors; afterwards as exact sensors would have made it
/// @param motion that the recording shows: of the readings themselves it would have the sensors' faults
/// @return whether there was anything to take off
bool placeSensors(Recording& recording, const SensorLayout& layout, const SensorErrors& errors,
                  const RunMotion& motion);

/// The layout with the places and, of triads that this recording has not whole, the directions that errors say: what
/// noise makes of the motion of corrected readings is what it makes of these sensors.
SensorLayout moveSensors(SensorLayout layout, const SensorErrors& errors, const Recording& recording);

}  // namespace wems::identify
