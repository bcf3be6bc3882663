#include "identify/forward/drive.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "identify/forward/step_size.hpp"
#include "identify/merge/merge.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {

namespace {

/// Slope of each row per sample, by the five-point difference inside and three-point differences at the ends.
Eigen::Matrix3Xd calcSlopes(const Eigen::Matrix3Xd& signal) {
    const Eigen::Index n = signal.cols();
    Eigen::Matrix3Xd slopes = Eigen::Matrix3Xd::Zero(3, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        if (k >= 2 && k + 2 < n) {
            slopes.col(k) =
                (signal.col(k - 2) - 8 * signal.col(k - 1) + 8 * signal.col(k + 1) - signal.col(k + 2)) / 12;
        } else if (k >= 1 && k + 1 < n) {
            slopes.col(k) = (signal.col(k + 1) - signal.col(k - 1)) / 2;
        } else if (n >= 3) {
            const Eigen::Index inward = k == 0 ? 1 : -1;
            slopes.col(k) = static_cast<double>(inward) *
                            (-3 * signal.col(k) + 4 * signal.col(k + inward) - signal.col(k + 2 * inward)) / 2;
        } else if (n == 2) {
            slopes.col(k) = signal.col(1) - signal.col(0);
        }
    }
    return slopes;
}

/// Where a time falls between two samples.
struct Position {
    Eigen::Index interval;
    double part;  // 0…1
    bool inside;
};
Position locate(const std::vector<double>& time, double t) {
    const auto last = static_cast<double>(time.size() - 1);
    const double step = (time.back() - time.front()) / last;
    const double samples = (t - time.front()) / step;
    const double rounding = 1e-6;  // of a sample: grids share their times with the recording up to rounding
    const double whole = std::clamp(std::floor(samples + rounding), 0.0, last - 1);
    return {static_cast<Eigen::Index>(whole), std::clamp(samples - whole, 0.0, 1.0),
            samples > -rounding && samples < last + rounding};
}

/// Cubic Hermite polynomial on one sample interval: value, and derivative per sample.
struct HermiteBasis {
    double value0, slope0, value1, slope1;
};
HermiteBasis calcHermite(double s) {
    return {(1 + 2 * s) * (1 - s) * (1 - s), s * (1 - s) * (1 - s), s * s * (3 - 2 * s), s * s * (s - 1)};
}
HermiteBasis calcHermiteDerivative(double s) {
    return {6 * s * (s - 1), (1 - s) * (1 - 3 * s), 6 * s * (1 - s), s * (3 * s - 2)};
}
Eigen::Vector3d combine(const HermiteBasis& basis, const Eigen::Matrix3Xd& values, const Eigen::Matrix3Xd& slopes,
                        Eigen::Index k) {
    return basis.value0 * values.col(k) + basis.slope0 * slopes.col(k) + basis.value1 * values.col(k + 1) +
           basis.slope1 * slopes.col(k + 1);
}

/// What Hermite polynomials between samples leave of a signal, RMS over that of the signal: (2π f / f_s)^4 / 384 of
/// what lies at f.
double calcHermiteError(const Eigen::VectorXd& signal, double interval) {
    const Spectrum spectrum = calcSpectrum(signal, interval);
    const Eigen::ArrayXd share = (kTwoPi * interval * spectrum.frequency.array()).pow(4) / 384;
    const double power = spectrum.density.sum();
    return power > 0 ? std::sqrt((share.square() * spectrum.density.array()).sum() / power) : 0;
}

/// What polynomials may lose of a row, RMS over that of the row: as the integrator's steps are chosen, of the motion
/// (step_size.hpp).
constexpr double kLargestHermiteError = 2e-3;

/// A row continued at both ends by point reflection, which keeps its value and its slope there, as far as the windowed
/// sinc reaches.
UniformSignal continueRow(const Eigen::VectorXd& row, double start, double interval) {
    const auto last = row.size() - 1;
    const Eigen::Index reach = std::min<Eigen::Index>(48, last);  // 32 zero crossings, each of up to 1.2 samples
    UniformSignal signal{start - interval * static_cast<double>(reach), interval, {}};
    for (Eigen::Index k = reach; k >= 1; --k) signal.values.push_back(2 * row[0] - row[k]);
    signal.values.insert(signal.values.end(), row.begin(), row.end());
    for (Eigen::Index k = 1; k <= reach; ++k) signal.values.push_back(2 * row[last] - row[last - k]);
    return signal;
}

/// The rows of which polynomials lose more than that: by a windowed sinc, which takes them as they were before they
/// were sampled, without what lies above half the rate.
void tabulateCoarseRows(const std::vector<double>& time, const Eigen::Matrix3Xd& signal, const TimeGrid& grid,
                        double largest_error, Eigen::Matrix3Xd& table) {
    const double interval = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd row = signal.row(axis);
        if (row.isZero(0) || !(calcHermiteError(row, interval) > largest_error)) continue;
        const UniformSignal fine =
            resample(continueRow(row, time.front(), interval), grid.start, 0.5 * grid.step(), grid.halfSteps());
        for (int half = 0; half < grid.halfSteps(); ++half)
            if (locate(time, grid.halfStepTime(half)).inside) table(axis, half) = fine.values[half];
    }
}

Eigen::Matrix3Xd tabulate(const std::vector<double>& time, const Eigen::Matrix3Xd& signal, const TimeGrid& grid) {
    if (signal.cols() == 0) return {};
    const Eigen::Matrix3Xd slopes = calcSlopes(signal);
    Eigen::Matrix3Xd table = Eigen::Matrix3Xd::Zero(3, grid.halfSteps());
    for (int half = 0; half < grid.halfSteps(); ++half) {
        const Position at = locate(time, grid.halfStepTime(half));
        if (at.inside) table.col(half) = combine(calcHermite(at.part), signal, slopes, at.interval);
    }
    tabulateCoarseRows(time, signal, grid, kLargestHermiteError, table);
    return table;
}

/// A recorded motion at the table's times, and its rate per second.
struct TabulatedMotion {
    Eigen::Matrix3Xd value, rate;
};

/// @param slopes per sample @param coarse they are none that hold: all rows by the windowed sinc, their rates
///     five-point differences of it, good to (ω h / 2)^4 / 30
TabulatedMotion tabulateMotion(const std::vector<double>& time, const Eigen::Matrix3Xd& signal,
                               const Eigen::Matrix3Xd& slopes, const TimeGrid& grid, bool coarse) {
    const double interval = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    TabulatedMotion motion{Eigen::Matrix3Xd(3, grid.halfSteps()), Eigen::Matrix3Xd(3, grid.halfSteps())};
    for (int half = 0; half < grid.halfSteps(); ++half) {
        const Position at = locate(time, grid.halfStepTime(half));
        if (!at.inside) throw std::invalid_argument("Drive::makeFixedMotion: the grid leaves the recorded time");
        motion.value.col(half) = combine(calcHermite(at.part), signal, slopes, at.interval);
        motion.rate.col(half) = combine(calcHermiteDerivative(at.part), signal, slopes, at.interval) / interval;
    }
    if (!coarse) return motion;
    tabulateCoarseRows(time, signal, grid, 0, motion.value);
    motion.rate = calcSlopes(motion.value) / (0.5 * grid.step());
    return motion;
}

/// The load as the recording that its frequency is told from.
Recording makeLoadRecording(const std::vector<double>& time, const Eigen::Matrix3Xd& load) {
    Recording recording;
    recording.time = time;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::RowVectorXd values = load.row(axis);
        Channel channel;
        channel.name = formatChannelName({Part::load, {}, axis, Derivative::force});
        channel.values.assign(values.begin(), values.end());
        recording.channels.push_back(std::move(channel));
    }
    return recording;
}

/// True if the recorded motion of the fixed part drives, rather than what acts on bracket or base.
bool followsRecordedFrame(const RunMotion& run, const MountModel& model, bool loaded) {
    if (run.fixed_source != FixedSource::channels) return false;
    if (model.bracket.empty()) return true;
    const bool on_mobile = model.load_point && model.load_point->part == Part::mobile;
    const bool participates = std::any_of(model.bracket.begin(), model.bracket.end(),
                                          [](const BracketMode& mode) { return !mode.base_participation.isZero(0); });
    // A base that the modes know nothing of would leave the bracket at rest.
    if (run.base.cols() > 0) return !participates && (!loaded || on_mobile);
    return !loaded;
}

/// Position and rotation by cubic Hermite polynomials, which both rows' velocities are the slopes of: exact where both
/// lie between the same two samples, but for the rotation from the first row being taken as small.
void interpolateFrame(const FrameRow& from, const FrameRow& to, double part, double h, FrameRow& between) {
    const FrameMotion a = makeFrameMotion(from), b = makeFrameMotion(to);
    const HermiteBasis value = calcHermite(part), slope = calcHermiteDerivative(part);
    const Eigen::Vector3d turn = vectorFromRotation(b.R_GF * a.R_GF.transpose());
    const Eigen::Vector3d turn_rate = leftJacobian(turn).inverse() * b.w_GF;
    const Eigen::Vector3d turned = value.slope0 * h * a.w_GF + value.value1 * turn + value.slope1 * h * turn_rate;
    FrameMotion motion;
    motion.R_GF = rotationFromVector(turned) * a.R_GF;
    motion.w_GF = leftJacobian(turned) * (slope.slope0 * a.w_GF + slope.value1 * turn / h + slope.slope1 * turn_rate);
    motion.p_GF = value.value0 * a.p_GF + value.slope0 * h * a.v_GF + value.value1 * b.p_GF + value.slope1 * h * b.v_GF;
    motion.v_GF = (slope.value0 * a.p_GF + slope.value1 * b.p_GF) / h + slope.slope0 * a.v_GF + slope.slope1 * b.v_GF;
    between = makeFrameRow(motion);
}

}  // namespace

FrameMotion makeFrameMotion(const FrameRow& row) {
    FrameMotion motion;
    motion.R_GF = Eigen::Map<const Eigen::Matrix3d>(row.R_GF);
    motion.p_GF = Eigen::Map<const Eigen::Vector3d>(row.p_GF);
    motion.w_GF = Eigen::Map<const Eigen::Vector3d>(row.w_GF);
    motion.v_GF = Eigen::Map<const Eigen::Vector3d>(row.v_GF);
    return motion;
}

FrameRow makeFrameRow(const FrameMotion& motion) {
    FrameRow row{};
    Eigen::Map<Eigen::Matrix3d>(row.R_GF) = motion.R_GF;
    Eigen::Map<Eigen::Vector3d>(row.p_GF) = motion.p_GF;
    Eigen::Map<Eigen::Vector3d>(row.w_GF) = motion.w_GF;
    Eigen::Map<Eigen::Vector3d>(row.v_GF) = motion.v_GF;
    return row;
}

DriveRows Drive::rows() const {
    DriveRows rows;
    if (load().cols() > 0) rows.load = load().data();
    for (int axis = 0; axis < 3; ++axis) rows.load_shift[axis] = load_shift_[axis];
    if (base().cols() > 0) rows.base = base().data();
    if (prescribesMotion()) rows.frames = tables_->frames.data();
    rows.interpolate = interpolateFrame;
    rows.elapsed = elapsedTime(0);
    rows.half_step = 0.5 * grid_.step();
    rows.count = grid_.halfSteps();
    return rows;
}

TimeGrid makeGrid(const RunMotion& run, const MountModel& model) {
    TimeGrid grid;
    grid.start = run.time.front();
    grid.interval = run.interval;
    grid.samples = static_cast<int>(run.time.size());
    grid.steps_per_sample = chooseStepsPerSample(model, run.interval);
    return grid;
}

Drive Drive::makeFree(const TimeGrid& grid) {
    return Drive(grid, grid.start, {});
}

Drive::Tables Drive::tabulateLoad(const std::vector<double>& time, const Eigen::Matrix3Xd& load,
                                  const Eigen::Matrix3Xd& base, const TimeGrid& grid) {
    if (time.size() < 2) throw std::invalid_argument("Drive::makeLoad: at least two samples are needed");
    Tables tables;
    tables.load = tabulate(time, load, grid);
    tables.base = tabulate(time, base, grid);
    if (load.cols() == 0) return tables;
    const SweptFrequency swept = findSweptFrequency(makeLoadRecording(time, load));
    if (!swept.is_sine) return tables;
    const Eigen::VectorXd& frequency = swept.hertz;
    tables.frequency.resize(grid.halfSteps());
    for (int half = 0; half < grid.halfSteps(); ++half) {
        const Position at = locate(time, grid.halfStepTime(half));
        tables.frequency(half) = frequency(at.interval) * (1 - at.part) + frequency(at.interval + 1) * at.part;
    }
    return tables;
}

Drive Drive::makeLoad(const std::vector<double>& time, const Eigen::Matrix3Xd& load, const Eigen::Matrix3Xd& base,
                      const TimeGrid& grid) {
    Tables tables = tabulateLoad(time, load, base, grid);
    return Drive(grid, time.front(), std::move(tables));
}

Drive Drive::makeFixedMotion(const std::vector<double>& time, const PartMotion& fixed, const TimeGrid& grid,
                             const Eigen::Matrix3Xd& load, bool coarse) {
    Tables tables = tabulateLoad(time, load, {}, grid);
    const double interval = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    const Eigen::Matrix3Xd velocity = interval * fixed.v;
    Eigen::Matrix3Xd rotation_rate(3, fixed.w.cols());
    for (Eigen::Index k = 0; k < fixed.w.cols(); ++k)
        rotation_rate.col(k) = interval * leftJacobian(fixed.theta.col(k)).inverse() * fixed.w.col(k);
    const TabulatedMotion place = tabulateMotion(time, fixed.p, velocity, grid, coarse);
    const TabulatedMotion turn = tabulateMotion(time, fixed.theta, rotation_rate, grid, coarse);
    tables.frames.resize(grid.halfSteps());
    for (int half = 0; half < grid.halfSteps(); ++half) {
        FrameMotion frame;
        frame.R_GF = rotationFromVector(turn.value.col(half));
        frame.p_GF = place.value.col(half);
        frame.v_GF = place.rate.col(half);
        frame.w_GF = leftJacobian(turn.value.col(half)) * turn.rate.col(half);
        tables.frames[half] = makeFrameRow(frame);
    }
    return Drive(grid, time.front(), std::move(tables));
}

Drive Drive::withLoadShift(const Eigen::Vector3d& force) const {
    if (load().cols() == 0) throw std::logic_error("Drive::withLoadShift: there is no load");
    Drive shifted = *this;
    shifted.load_shift_ = force;
    return shifted;
}

Bracket::FrameAcceleration Drive::calcFrameAcceleration(int half) const {
    const int before = std::max(0, half - 1);
    const int after = std::min(grid_.halfSteps() - 1, half + 1);
    if (after == before) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    const double duration = 0.5 * grid_.step() * (after - before);
    return {(frame(after).w_GF - frame(before).w_GF) / duration, (frame(after).v_GF - frame(before).v_GF) / duration};
}

Drive Drive::make(const RunMotion& run, const MountModel& model, const TimeGrid& grid) {
    const bool loaded = run.load.cols() > 0 && loadActs(model), based = run.base.cols() > 0;
    const Eigen::Matrix3Xd load = loaded ? run.load : Eigen::Matrix3Xd();
    if (followsRecordedFrame(run, model, loaded))
        return makeFixedMotion(run.time, run.fixed, grid, load,
                               run.sufficient_rate > 0 && !run.fixed.acceleration_measured);
    Tables tables = tabulateLoad(run.time, load, run.base, grid);
    if (based) tables.base_displacement = tabulate(run.time, run.base_displacement, grid);
    return Drive(grid, run.time.front(), std::move(tables));
}

}  // namespace wems::identify
