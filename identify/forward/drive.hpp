/// @file
/// What drives a free simulation, tabulated once at every time that the integrator asks for and then shared by as
/// many simulations as wanted: a load or base acceleration on the bracket, or the motion of the fixed part.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "identify/motion/motion.hpp"
#include "models/bracket.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

// What drives a simulation as the integrator reads it: plain tables.

/// Prescribed motion of the fixed part at one time, by columns.
struct FrameRow {
    double R_GF[9], p_GF[3], w_GF[3], v_GF[3];
};

/// What drives, at all half steps of the grid.
struct DriveRows {
    const double* load = nullptr;      ///< 3 for each half step; null without
    double load_shift[3] = {0, 0, 0};  ///< on the load of all rows
    const double* base = nullptr;      ///< likewise
    const FrameRow* frames = nullptr;  ///< likewise
    /// The motion at a part (0…1) between two rows, h (s) apart.
    void (*interpolate)(const FrameRow& from, const FrameRow& to, double part, double h, FrameRow& between) = nullptr;
    double elapsed = 0, half_step = 0;  ///< s: at the first half step, and between two
    int count = 0;
};

/// Uniform times of a simulation: samples, and the integrator's steps between two samples.
struct TimeGrid {
    double start = 0;          ///< s, time of the first sample
    double interval = 0;       ///< s between samples
    int samples = 0;           ///< ≥ 1
    int steps_per_sample = 1;  ///< ≥ 1

    double step() const { return interval / steps_per_sample; }
    double sampleTime(int sample) const { return start + sample * interval; }
    /// Number of table rows: the integrator needs the start, the middle and the end of each step.
    int halfSteps() const { return 2 * steps_per_sample * (samples - 1) + 1; }
    /// Table row of a sample.
    int halfStepOf(int sample) const { return 2 * steps_per_sample * sample; }
    double halfStepTime(int half) const { return start + 0.5 * step() * half; }
};

/// The samples of a run with the steps that `model` needs between them.
TimeGrid makeGrid(const RunMotion& run, const MountModel& model);

FrameMotion makeFrameMotion(const FrameRow& row);
FrameRow makeFrameRow(const FrameMotion& motion);

class Drive {
public:
    /// Nothing acts from outside; a bracket, if the model has one, is free, otherwise the fixed part stands still.
    static Drive makeFree(const TimeGrid& grid);

    /// Load at the bracket's load point (3 x n, N) and base acceleration (3 x n, m/s²) at the times `time` (s,
    /// uniform); either may be empty. Between samples cubic Hermite with slopes of fourth order: a signal of frequency
    /// f sampled at f_s is met to (2π f / f_s)^4 / 384 or better, where linear interpolation would lose (2π f / f_s)²
    /// / 12 of its amplitude (0.8 % at 50 Hz and 1 kHz). Axes of which more than 0.2 % would be lost are interpolated
    /// by a windowed sinc instead (merge/merge.hpp). Zero outside the recorded time.
    static Drive makeLoad(const std::vector<double>& time, const Eigen::Matrix3Xd& load, const Eigen::Matrix3Xd& base,
                          const TimeGrid& grid);

    /// Recorded motion of the fixed part: position and rotation vector cubic Hermite, velocities their derivatives.
    /// `load` (3 x n, N; may be empty) is a load on the mobile part.
    /// @param coarse too few samples in a period for derivatives: positions by a windowed sinc, velocities as its own
    /// @throws std::invalid_argument if the grid leaves the recorded time.
    static Drive makeFixedMotion(const std::vector<double>& time, const PartMotion& fixed, const TimeGrid& grid,
                                 const Eigen::Matrix3Xd& load = {}, bool coarse = false);

    /// What the error of a free simulation is defined with:
    /// - with a bracket: the load and base acceleration that were recorded; the recorded motion of the fixed part if
    ///   there is neither, or only a base acceleration that the modes have no participation in;
    /// - without: the recorded motion of the fixed part; where it only follows the base, the base acceleration itself,
    ///   exact at all frequencies, with all motion relative to the base; where it stands still, nothing;
    /// - a load on the mobile part always acts.
    static Drive make(const RunMotion& run, const MountModel& model, const TimeGrid& grid);

    /// The same drive with a constant force on the load of all rows, N; load() stays as it was recorded. Both share
    /// their tables. @throws std::logic_error without load
    Drive withLoadShift(const Eigen::Vector3d& force) const;

    const TimeGrid& grid() const { return grid_; }
    bool prescribesMotion() const { return !tables_->frames.empty(); }

    /// All tables as the integrator reads them; refers to this object.
    DriveRows rows() const;
    /// Motion of F at a table row; prescribesMotion() only.
    FrameMotion frame(int half) const { return makeFrameMotion(tables_->frames[half]); }
    /// Its acceleration, by differences of the tabulated velocities; prescribesMotion() only.
    Bracket::FrameAcceleration calcFrameAcceleration(int half) const;
    /// Time since the start of the recording (s), which drift counts from.
    double elapsedTime(int half) const { return grid_.halfStepTime(half) - origin_; }
    /// Load (N) and base acceleration (m/s²) at all table rows, in G; empty if there is none.
    const Eigen::Matrix3Xd& load() const { return tables_->load; }
    const Eigen::Matrix3Xd& base() const { return tables_->base; }
    /// Displacement of the base (m) where make() knows it, for markers; empty otherwise.
    const Eigen::Matrix3Xd& baseDisplacement() const { return tables_->base_displacement; }
    /// Swept frequency (Hz) of the load at all table rows; empty without load.
    const Eigen::VectorXd& sweptFrequency() const { return tables_->frequency; }

private:
    struct Tables {
        std::vector<FrameRow> frames;
        Eigen::Matrix3Xd load, base, base_displacement;
        Eigen::VectorXd frequency;
    };
    Drive(const TimeGrid& grid, double origin, Tables tables)
        : grid_(grid), origin_(origin), tables_(std::make_shared<const Tables>(std::move(tables))) {}
    static Tables tabulateLoad(const std::vector<double>& time, const Eigen::Matrix3Xd& load,
                               const Eigen::Matrix3Xd& base, const TimeGrid& grid);

    TimeGrid grid_;
    double origin_;
    Eigen::Vector3d load_shift_ = Eigen::Vector3d::Zero();
    std::shared_ptr<const Tables> tables_;
};

}  // namespace wems::identify
