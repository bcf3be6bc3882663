/// @file
/// The error of a free simulation against recordings, as the results define it.
///
/// Error: root mean square of (simulated − measured) relative displacement over that of the measured one, pooled over
/// all recordings, connections and axes. The simulation is driven by the recorded load wherever the model has a
/// bracket and the recording a load, otherwise by the recorded motion of the fixed part. Where only accelerations were
/// recorded, both sides are compared above the lowest frequency at which the motion is known (kComparedMargin).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "identify/motion/motion.hpp"
#include "identify/motion/noise_density.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

/// Measured relative displacement of a run from rest: row 3 i + axis, F axes, m; rows of connections that were not
/// recorded are those of the rigid motion.
/// @param model that the motion was estimated with: its sag is a part of the motion
Eigen::MatrixXd calcMeasuredRelative(const Recording& recording, const RunMotion& run, const MountModel& model);

/// What the noise of the drive makes of a free simulation: mean square of its draws and how much they scatter.
struct DrivenNoise {
    double square = 0, deviation = 0;
};

struct FreeError {
    double error = 0;         ///< see above
    double noise_floor = 0;   ///< what the recordings' noise alone gives
    bool diverged = false;    ///< a simulation grew beyond all bounds; error is then infinite
    DrivenNoise driven = {};  ///< of the squared error; none where it was not asked for
};

/// Contract, verdict: an error asks for a cause if it lies above both.
inline constexpr double kFloors = 1.5;       ///< noise floors
inline constexpr double kLeastError = 0.03;  ///< of the measured motion
inline bool isWorthExplaining(const FreeError& own) {
    return own.error > kFloors * own.noise_floor && own.error > kLeastError;
}

/// Of the error of the prediction: a cause that changes it by less is of no use to who reads it. On recordings of
/// another simulator true causes changed it by 13 % and more, a mode far above the sweep that was off by noise alone by
/// 1 %.
inline constexpr double kWorth = 0.05;
/// That share is of what the noise of the drive leaves to be explained. Errors add as squares; how large the noise is
/// in one recording is known to its scatter.
double calcExplainable(const FreeError& error);
/// Whether a prediction is as good without a cause: worse by less than that.
bool isWorthless(const FreeError& with, const FreeError& without);
/// Whether a prediction is better than another by at least that.
bool isImproved(const FreeError& before, const FreeError& after);
/// Whether a prediction is worse than another by more than that, and not as good as asked for.
bool isSpoilt(const FreeError& before, const FreeError& after);
/// Whether a cause's part of the error lies below the noise that the prediction is compared with. Errors add as
/// squares.
bool isBelowNoise(const FreeError& with, const FreeError& without);

/// Variance of one sample of what drives a run; none of what is not recorded. Of the fixed part that of its motion,
/// which several channels determine together.
struct DriveNoise {
    std::optional<NoiseDensity> displacement, acceleration;  ///< of the fixed part: m², (m/s²)²
    std::optional<NoiseDensity> base;                        ///< (m/s²)²
    std::optional<NoiseDensity> load;                        ///< N²
    double lowest = 0, highest = 0;                          ///< Hz, that the run is excited from and to
};

/// One run with what it is compared with.
struct FreeRun {
    const RunMotion* motion;
    Eigen::MatrixXd measured;
    /// m², of one compared value, by the mobile and the fixed part: of displacement channels, or what integration
    /// leaves of the accelerations' noise. Where it is not known better than by the scatter of the rigid fits: nothing.
    std::array<std::optional<double>, 2> displacement_noise = {};
    DriveNoise drive = {};
};
/// Where a comparison begins, Hz: 0, but where the motion of either part is integrated from accelerations alone.
double calcLowestCompared(const RunMotion& run);
/// Simulated minus measured, as the error compares them. @throws SimulationDiverged
Eigen::MatrixXd calcFreeResidual(const FreeRun& run, const MountModel& model);
/// Sum of squares of the measured displacements, as the error compares them, m².
double calcComparedSquares(const FreeRun& run);
/// What the recording's noise gives one relative displacement, m².
double calcNoiseVariance(const FreeRun& run, const MountModel& model);
FreeError calcFreeError(const std::vector<FreeRun>& runs, const MountModel& model);

}  // namespace wems::identify
