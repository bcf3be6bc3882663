/// @file
/// What free simulations leave of the recorded relative displacements, and how that changes with the numbers of a
/// model.
///
/// Residual of connection axis i at sample k:
///
///     e_ik = q_i(t_k; numbers, start of its piece, load − z_load) + a_i z_rest − q_ik measured
///
/// A run is one piece, or several that each begin where the recording was. z_rest are the free motions of the mobile
/// part that its sensors read at rest (a_i: what they are at axis i), z_load what each axis of the load reads of
/// nothing. The first instant of a piece is unknown, unless its run begins at rest.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/forward/compare.hpp"
#include "identify/motion/motion.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Where the unknowns stand, and what they are measured against.
struct TrajectoryLayout {
    std::vector<std::string> names;  ///< of the model's numbers, which come first
    std::vector<int> rest_motions;   ///< of x y z rx ry rz, then
    std::vector<int> load_axes;      ///< then
    std::vector<int> start_counts;   ///< of each piece: positions and velocities of those motions; 0 from rest; last

    Eigen::Index restAt() const { return names.size(); }
    Eigen::Index loadAt() const { return restAt() + static_cast<Eigen::Index>(rest_motions.size()); }
    /// Of a piece; past the last one all unknowns.
    Eigen::Index startAt(std::size_t piece) const;
    Eigen::Index size() const { return startAt(start_counts.size()); }
};

/// Values of all unknowns.
struct TrajectoryPoint {
    MountModel model;
    Eigen::VectorXd others;  ///< those that follow the model's numbers, SI
};

/// Residual of one piece and its derivatives: rows of one sample after those of the other.
struct TrajectoryTangent {
    Eigen::VectorXd residual;
    Eigen::MatrixXd jacobian;            ///< a column for each of
    std::vector<Eigen::Index> unknowns;  ///< the layout's
    Eigen::Index axes = 0;               ///< rows of one sample
};

/// Samples of a run that are simulated by themselves.
struct TrajectoryPiece {
    std::size_t run = 0;
    int first = 0, count = 0;
};

/// Runs prepared for being simulated many times, which several problems may share.
class TrajectoryRuns {
public:
    /// @param refinement integration steps for each that a comparison takes
    /// @throws InputError if a run has no measured displacements
    TrajectoryRuns(const std::vector<RunMotion>& runs, const MountModel& model, int refinement);

    std::size_t size() const { return prepared_.size(); }
    const PreparedRun& operator[](std::size_t run) const { return prepared_[run]; }
    const RunMotion& motion(std::size_t run) const { return motions_[run]; }
    /// Mean square of the measured displacements of a run, m².
    double meanSquare(std::size_t run) const { return mean_squares_[run]; }
    int refinement() const { return refinement_; }

    /// Each run as a whole.
    std::vector<TrajectoryPiece> keepWhole() const;
    /// All samples in pieces of so many periods of the motion or somewhat more, one after the other, or so many pieces
    /// spread evenly; none where the state is not known at their start: with a bracket that is free, or relative to a
    /// base that is known by its acceleration alone.
    std::vector<TrajectoryPiece> cut(double periods, int most_pieces) const;
    /// What comes first of each piece, so many periods at most.
    std::vector<TrajectoryPiece> shorten(std::vector<TrajectoryPiece> pieces, double periods) const;

    /// Runs that seem to begin at rest. With few samples in a period noise is told from motion badly, so that a fit
    /// should ask whether rest is as good as a start that it finds.
    std::vector<std::size_t> listQuietStarts() const;
    /// Whether a run is simulated from rest: those with a state that was not recorded, and those that a fit found so.
    bool beginsAtRest(std::size_t run) const { return at_rest_[run]; }
    void setAtRest(std::size_t run, bool at_rest) { at_rest_[run] = at_rest; }

private:
    int findLength(std::size_t run, double periods) const;

    const std::vector<RunMotion>& motions_;  // which outlive this
    std::vector<PreparedRun> prepared_;
    std::vector<double> mean_squares_;
    std::vector<bool> at_rest_;
    int refinement_;
    bool starts_are_open_ = false;
};

class TrajectoryProblem {
public:
    /// @param runs  must outlive this
    /// @param names numbers of the model (models/parameter_access.hpp)
    TrajectoryProblem(const TrajectoryRuns& runs, std::vector<TrajectoryPiece> pieces, const MountModel& model,
                      std::vector<std::string> names);

    const TrajectoryLayout& layout() const { return layout_; }
    /// Sizes that the unknowns are counted in, > 0: believed values, RMS displacement, load and velocity.
    const Eigen::VectorXd& scale() const { return scale_; }
    const TrajectoryRuns& runs() const { return runs_; }
    const std::vector<TrajectoryPiece>& pieces() const { return pieces_; }
    /// Values of a piece's residual: all samples of the rows that any free motion moves.
    Eigen::Index residualCount(std::size_t piece) const;
    /// Sum of squares of the measured displacements of a piece, m².
    double measuredSquares(std::size_t piece) const;
    /// Of x y z rx ry rz unit motions, what connection axes (rows 3 i + axis) move by.
    const Eigen::MatrixXd& rigidPattern() const { return pattern_; }

    /// The believed model at the measured starts, zeros of nothing.
    const TrajectoryPoint& start() const { return start_; }
    /// Another problem's model and zeros, and its starts of pieces that begin at the same samples; otherwise the
    /// measured ones.
    TrajectoryPoint adopt(const TrajectoryProblem& other, const TrajectoryPoint& point) const;
    /// By how much each unknown may fall before its number would be negative where it must not be, over its scale;
    /// infinite for all others.
    Eigen::VectorXd calcRoom(const TrajectoryPoint& point) const;
    /// @throws InputError if there is no such model
    TrajectoryPoint move(const TrajectoryPoint& point, const Eigen::VectorXd& change) const;

    /// Unknowns over their scales; of the model's numbers nothing.
    Eigen::VectorXd collectOthers(const TrajectoryPoint& point) const;
    /// What the sensors read at rest, at each connection axis, m.
    Eigen::VectorXd calcRestReading(const TrajectoryPoint& point) const;
    /// Relative displacements, from rest. @throws SimulationDiverged
    Eigen::MatrixXd simulate(std::size_t piece, const TrajectoryPoint& point) const;
    /// @throws SimulationDiverged
    Eigen::VectorXd calcResidual(std::size_t piece, const TrajectoryPoint& point) const;
    /// Differences, each over a step that changes the motion by about a hundred-thousandth.
    TrajectoryTangent linearise(std::size_t piece, const TrajectoryPoint& point);

private:
    ForwardState makeStart(std::size_t piece, const ForwardModel& forward, const TrajectoryPoint& point) const;
    bool beginsAtRest(const TrajectoryPiece& piece) const { return piece.first == 0 && runs_.beginsAtRest(piece.run); }
    void setScales();
    std::vector<Eigen::Index> listUnknowns(std::size_t piece) const;

    const TrajectoryRuns& runs_;
    std::vector<TrajectoryPiece> pieces_;
    MountModel believed_;
    TrajectoryLayout layout_;
    TrajectoryPoint start_;
    Eigen::VectorXd scale_, step_;
    Eigen::MatrixXd pattern_;
    std::vector<int> rows_;           // of the pattern, that any free motion moves
    std::vector<bool> not_negative_;  // of the model's numbers
};

}  // namespace wems::identify
