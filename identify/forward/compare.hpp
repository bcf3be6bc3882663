/// @file
/// Measured against simulated relative displacements: one error for all, and where it sits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/forward/drive.hpp"
#include "identify/forward/initial_state.hpp"
#include "identify/forward/relative_displacement.hpp"

namespace wems::identify {

/// Root mean square of a difference over that of the reference, over any number of pieces.
class ErrorSum {
public:
    void add(double difference, double reference) {
        difference_ += difference * difference;
        reference_ += reference * reference;
    }
    void add(const ErrorSum& other) {
        difference_ += other.difference_;
        reference_ += other.reference_;
    }
    bool empty() const { return reference_ == 0; }
    /// The error; NaN if nothing moved.
    double value() const;
    double differenceSquares() const { return difference_; }
    double referenceSquares() const { return reference_; }

private:
    double difference_ = 0, reference_ = 0;
};

struct BandError {
    double from = 0, to = 0;  ///< Hz, of swept frequency
    double error = 0;
};

struct ChannelError {
    std::string name;  ///< `4.z`
    double error = 0;  ///< of this channel, relative to itself
    double rms = 0;    ///< of the measured channel, m
    double share = 0;  ///< of the squared error of all channels
    std::vector<BandError> bands;
    std::optional<double> free, contact;  ///< while no stop of the device is touched, and while any is; with a model
};

struct Comparison {
    double error = 0;  ///< root mean square of (simulated − measured) over that of measured, all channels together
    std::vector<ChannelError> channels;
    std::vector<BandError> bands;
    std::optional<double> free, contact;
    double from = 0, to = 0;         ///< s, the time compared
    std::vector<std::string> notes;  ///< what was interpolated, cut, filtered or left out
    /// Both motions as they were compared: a row for each of `channels`, a column for each of `time`; m.
    Eigen::MatrixXd measured, simulated;
    std::vector<double> time;         ///< s
    Eigen::VectorXd swept_frequency;  ///< Hz at each time, NaN where unknown
};

/// Compares at the measured samples of the common time range; the simulated ones are interpolated (cubic) where they
/// do not coincide. Where either rests on accelerations alone, both are compared above 0.9 times the lowest excited
/// frequency. Bands are half octaves of the swept frequency of the measured recording.
/// @param model tells when a stop is touched (by the measured motion); may be null
/// @throws InputError if the time ranges do not overlap or a measured channel is not in the simulated recording.
Comparison compare(RelativeDisplacement measured, RelativeDisplacement simulated, const MountModel* model);

/// True at each sample (column of q, rows 3 i + axis, from rest) at which any stop of the model is touched.
std::vector<bool> findContact(const Eigen::MatrixXd& q, const MountModel& model);

// The error of a model on a run: its free simulation against the measured relative displacements.

/// A run prepared for being simulated many times with changing parameters: drive tables and measured displacements.
struct PreparedRun {
    Drive drive;
    RelativeDisplacement measured;
    std::optional<StartMotion> start;  ///< empty: rest
    bool fixed_integrated = false;     ///< the fixed part's motion is integrated from accelerations, and simulated
};

/// @param lowest_frequency Hz, lowest excited frequency; only used where the run rests on accelerations alone
/// @param model chooses the step and the way of driving (load wherever there is a bracket and a load)
/// @param refinement steps for each that is usual
PreparedRun prepareRun(const RunMotion& run, const MountModel& model, double lowest_frequency, int refinement = 1);

/// Free simulation from the run's start (rest, or the motion that it begins with), relative displacements from rest;
/// filtered as the measured ones are. Where those are integrated from accelerations, so is what the simulated ones
/// would be recorded as: the kinks that contact leaves in accelerations fold into low frequencies at each sampling
/// rate, which integration magnifies (2 % of the displacement at 1 kHz, falling with the rate squared).
RelativeDisplacement simulateRun(const MountModel& model, const PreparedRun& run);

/// The sums of squares, to be pooled over runs. @throws SimulationDiverged
ErrorSum calcSimulationError(const MountModel& model, const PreparedRun& run);

}  // namespace wems::identify
