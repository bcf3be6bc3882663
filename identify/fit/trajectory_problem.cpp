#include "identify/fit/trajectory_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/parallel.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

constexpr double kStepEffect = 1e-5;  // of a step of a finite difference, over the size of the motion

double rootMeanSquare(const Eigen::MatrixXd& values) {
    return values.size() > 0 ? std::sqrt(values.squaredNorm() / static_cast<double>(values.size())) : 0;
}

/// Samples in a period of what moves most, as its velocity and displacement have it.
double countPeriodSamples(const Eigen::MatrixXd& q) {
    Eigen::Index most = 0;
    q.rowwise().squaredNorm().maxCoeff(&most);
    const Eigen::VectorXd x = q.row(most).transpose().array() - q.row(most).mean();
    const double steps = rootMeanSquare(x.tail(x.size() - 1) - x.head(x.size() - 1));
    // A sine's steps are 2 sin(ω/2) of its RMS.
    const double sine = std::min(1.0, steps / (2 * std::max(rootMeanSquare(x), 1e-300)));
    return sine > 0 ? kPi / std::asin(sine) : static_cast<double>(x.size());
}

/// Axes along which any run has a load that acts.
std::vector<int> findLoadAxes(const TrajectoryRuns& runs) {
    std::vector<int> axes;
    for (int axis = 0; axis < 3; ++axis)
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const Eigen::Matrix3Xd& load = runs[r].drive.load();
            if (load.cols() == 0 || load.row(axis).isZero(0)) continue;
            axes.push_back(axis);
            break;
        }
    return axes;
}

std::vector<int> findMovingRows(const Eigen::MatrixXd& pattern, const std::vector<int>& motions) {
    std::vector<int> rows;
    for (Eigen::Index i = 0; i < pattern.rows(); ++i)
        if (std::any_of(motions.begin(), motions.end(), [&](int motion) { return pattern(i, motion) != 0; }))
            rows.push_back(static_cast<int>(i));
    return rows;
}

/// Motion of both parts at a sample.
StartMotion pickMotion(const RunMotion& run, int sample) {
    StartMotion start;
    const PartMotion &mobile = run.mobile, &fixed = run.fixed;
    start.mobile.R_GM = rotationFromVector(mobile.theta.col(sample));
    start.mobile.p_GM = mobile.p.col(sample);
    start.mobile.w_GM = mobile.w.col(sample);
    start.mobile.v_GM = mobile.v.col(sample);
    start.fixed.R_GF = rotationFromVector(fixed.theta.col(sample));
    start.fixed.p_GF = fixed.p.col(sample);
    start.fixed.w_GF = fixed.w.col(sample);
    start.fixed.v_GF = fixed.v.col(sample);
    return start;
}

}  // namespace

Eigen::Index TrajectoryLayout::startAt(std::size_t piece) const {
    Eigen::Index at = loadAt() + static_cast<Eigen::Index>(load_axes.size());
    for (std::size_t p = 0; p < piece; ++p) at += start_counts[p];
    return at;
}

TrajectoryRuns::TrajectoryRuns(const std::vector<RunMotion>& runs, const MountModel& model, int refinement)
    : motions_(runs), refinement_(refinement) {
    for (const RunMotion& run : runs) {
        if (!run.mobile.displacement_measured)
            throw InputError({run.file, 0, "mobile"},
                             "has no displacements, which free simulations are compared with here",
                             "recordings with displacements, or a fit to the equations of motion (--method motion)");
        prepared_.push_back(prepareRun(run, model, 0, refinement));
        mean_squares_.push_back(std::pow(rootMeanSquare(prepared_.back().measured.q), 2));
        const Drive& drive = prepared_.back().drive;
        if (!drive.prescribesMotion() && (!model.bracket.empty() || drive.base().cols() > 0)) starts_are_open_ = true;
    }
    for (const PreparedRun& run : prepared_) at_rest_.push_back(starts_are_open_ && !run.start);
}

std::vector<std::size_t> TrajectoryRuns::listQuietStarts() const {
    std::vector<std::size_t> quiet;
    for (std::size_t r = 0; r < size(); ++r)
        if (!starts_are_open_ && !prepared_[r].start) quiet.push_back(r);
    return quiet;
}

std::vector<TrajectoryPiece> TrajectoryRuns::keepWhole() const {
    std::vector<TrajectoryPiece> pieces;
    for (std::size_t r = 0; r < size(); ++r) pieces.push_back({r, 0, prepared_[r].drive.grid().samples});
    return pieces;
}

int TrajectoryRuns::findLength(std::size_t run, double periods) const {
    const int all = prepared_[run].drive.grid().samples;
    const double wanted = std::ceil(periods * countPeriodSamples(prepared_[run].measured.q));
    return wanted < all ? std::max(2, static_cast<int>(wanted)) : all;
}

std::vector<TrajectoryPiece> TrajectoryRuns::cut(double periods, int most_pieces) const {
    std::vector<TrajectoryPiece> pieces;
    if (starts_are_open_) return pieces;
    const int share = std::max(1, most_pieces / static_cast<int>(size()));
    for (std::size_t r = 0; r < size(); ++r) {
        const int all = prepared_[r].drive.grid().samples, length = findLength(r, periods), fit = all / length;
        for (int i = 0; i < std::min(fit, share); ++i) {
            if (fit > share) {
                pieces.push_back({r, static_cast<int>(static_cast<long>(i) * (all - length) / share), length});
                continue;
            }
            const int first = static_cast<int>(static_cast<long>(i) * all / fit);
            pieces.push_back({r, first, static_cast<int>((i + 1L) * all / fit) - first});
        }
    }
    return pieces;
}

std::vector<TrajectoryPiece> TrajectoryRuns::shorten(std::vector<TrajectoryPiece> pieces, double periods) const {
    for (TrajectoryPiece& piece : pieces) piece.count = std::min(piece.count, findLength(piece.run, periods));
    return pieces;
}

TrajectoryProblem::TrajectoryProblem(const TrajectoryRuns& runs, std::vector<TrajectoryPiece> pieces,
                                     const MountModel& model, std::vector<std::string> names)
    : runs_(runs), pieces_(std::move(pieces)), believed_(model) {
    layout_.names = std::move(names);
    for (int motion = 0; motion < 6; ++motion)
        if (model.body.free.at(motion)) layout_.rest_motions.push_back(motion);
    pattern_ = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(model.connections.size()), 6);
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        const Eigen::Index row = 3 * i;
        pattern_.block<3, 3>(row, 0) = Eigen::Matrix3d::Identity();
        pattern_.block<3, 3>(row, 3) = -crossMatrix(model.connections[i].position);
    }
    rows_ = findMovingRows(pattern_, layout_.rest_motions);
    for (const TrajectoryPiece& piece : pieces_)
        layout_.start_counts.push_back(beginsAtRest(piece) ? 0 : 2 * static_cast<int>(layout_.rest_motions.size()));
    layout_.load_axes = findLoadAxes(runs_);
    start_ = {model, Eigen::VectorXd::Zero(layout_.size() - layout_.restAt())};
    setScales();
    for (std::size_t j = 0; j < layout_.names.size(); ++j) {
        MountModel negative = model;
        setParameter(negative, layout_.names[j], -scale_[static_cast<Eigen::Index>(j)]);
        makeAdmissible(model, negative);
        not_negative_.push_back(getParameter(negative, layout_.names[j]) == 0);
    }
}

void TrajectoryProblem::setScales() {
    scale_.resize(layout_.size());
    for (std::size_t j = 0; j < layout_.names.size(); ++j) {
        const double value = std::abs(getParameter(believed_, layout_.names[j]));
        scale_[static_cast<Eigen::Index>(j)] = value > 0 ? value : parameterScale(believed_, layout_.names[j]);
    }
    double load = 0, displacement = 0, velocity = 0;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        load = std::max(load, rootMeanSquare(runs_.motion(r).load));
        displacement = std::max(displacement, std::sqrt(runs_.meanSquare(r)));
        const Eigen::MatrixXd& q = runs_[r].measured.q;
        velocity = std::max(velocity, rootMeanSquare(q.rightCols(q.cols() - 1) - q.leftCols(q.cols() - 1)) /
                                          runs_[r].measured.interval());
    }
    double arm = 0;
    for (const Connection& connection : believed_.connections) arm = std::max(arm, connection.position.norm());
    const auto sizeOf = [&](int motion, double translation) {
        return motion < 3 || !(arm > 0) ? translation : translation / arm;
    };
    Eigen::Index at = layout_.restAt();
    for (const int motion : layout_.rest_motions) scale_[at++] = sizeOf(motion, displacement);
    for (std::size_t a = 0; a < layout_.load_axes.size(); ++a) scale_[at++] = load;
    for (const int count : layout_.start_counts)
        for (const double size : {displacement, velocity})
            for (const int motion : layout_.rest_motions)
                if (count > 0) scale_[at++] = sizeOf(motion, size);
    for (double& scale : scale_)
        if (!(scale > 0)) scale = 1;
    step_ = kStepEffect * scale_;
}

Eigen::Index TrajectoryProblem::residualCount(std::size_t piece) const {
    return static_cast<Eigen::Index>(rows_.size()) * pieces_[piece].count;
}

double TrajectoryProblem::measuredSquares(std::size_t piece) const {
    const TrajectoryPiece& at = pieces_[piece];
    return runs_[at.run].measured.q.middleCols(at.first, at.count).squaredNorm();
}

TrajectoryPoint TrajectoryProblem::adopt(const TrajectoryProblem& other, const TrajectoryPoint& point) const {
    TrajectoryPoint adopted = start_;
    adopted.model = point.model;
    const Eigen::Index common = layout_.startAt(0) - layout_.restAt();
    adopted.others.head(common) = point.others.head(common);
    for (std::size_t p = 0; p < std::min(pieces_.size(), other.pieces_.size()); ++p) {
        const int count = layout_.start_counts[p];
        if (pieces_[p].run != other.pieces_[p].run || pieces_[p].first != other.pieces_[p].first ||
            count != other.layout_.start_counts[p])
            continue;
        adopted.others.segment(layout_.startAt(p) - layout_.restAt(), count) =
            point.others.segment(other.layout_.startAt(p) - layout_.restAt(), count);
    }
    return adopted;
}

Eigen::VectorXd TrajectoryProblem::calcRoom(const TrajectoryPoint& point) const {
    Eigen::VectorXd room = Eigen::VectorXd::Constant(layout_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t j = 0; j < layout_.names.size(); ++j) {
        const Eigen::Index row = j;
        if (not_negative_[j]) room[row] = std::max(0.0, getParameter(point.model, layout_.names[j]) / scale_[row]);
    }
    return room;
}

TrajectoryPoint TrajectoryProblem::move(const TrajectoryPoint& point, const Eigen::VectorXd& change) const {
    TrajectoryPoint moved = point;
    for (std::size_t j = 0; j < layout_.names.size(); ++j) {
        const Eigen::Index row = j;
        if (change[row] != 0)
            setParameter(moved.model, layout_.names[j],
                         getParameter(point.model, layout_.names[j]) + scale_[row] * change[row]);
    }
    const Eigen::Index count = layout_.size() - layout_.restAt();
    moved.others += scale_.tail(count).cwiseProduct(change.tail(count));
    makeAdmissible(believed_, moved.model);
    validate(moved.model);
    return moved;
}

ForwardState TrajectoryProblem::makeStart(std::size_t piece, const ForwardModel& forward,
                                          const TrajectoryPoint& point) const {
    const TrajectoryPiece& at = pieces_[piece];
    const PreparedRun& prepared = runs_[at.run];
    if (beginsAtRest(at)) return forward.restState(prepared.drive);
    const StartMotion measured =
        at.first == 0 && prepared.start ? *prepared.start : pickMotion(runs_.motion(at.run), at.first);
    ForwardState state = makeState(forward, measured, prepared.drive);
    const Eigen::Index count = layout_.rest_motions.size();
    const Eigen::VectorXd change = point.others.segment(layout_.startAt(piece) - layout_.restAt(), 2 * count);
    Eigen::Matrix<double, 6, 1> pose = Eigen::Matrix<double, 6, 1>::Zero(), rate = pose;
    pose(layout_.rest_motions) = change.head(count);
    rate(layout_.rest_motions) = change.tail(count);
    state.mobile.p_GM += pose.head<3>();
    state.mobile.R_GM = rotationFromVector(pose.tail<3>()) * state.mobile.R_GM;
    state.mobile.v_GM += rate.head<3>();
    state.mobile.w_GM += rate.tail<3>();
    return state;
}

Eigen::MatrixXd TrajectoryProblem::simulate(std::size_t piece, const TrajectoryPoint& point) const {
    const TrajectoryPiece& at = pieces_[piece];
    const Drive& drive = runs_[at.run].drive;
    const ForwardModel forward(point.model);
    Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    zero(layout_.load_axes) =
        point.others.segment(layout_.loadAt() - layout_.restAt(), static_cast<Eigen::Index>(layout_.load_axes.size()));
    const Simulation simulation = forward.simulate(drive.load().cols() > 0 ? drive.withLoadShift(-zero) : drive,
                                                   makeStart(piece, forward, point), at.first, at.count);
    return simulation.q.colwise() - forward.restDisplacement();
}

Eigen::VectorXd TrajectoryProblem::collectOthers(const TrajectoryPoint& point) const {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(layout_.size());
    const Eigen::Index count = point.others.size();
    change.tail(count) = point.others.cwiseQuotient(scale_.tail(count));
    return change;
}

Eigen::VectorXd TrajectoryProblem::calcRestReading(const TrajectoryPoint& point) const {
    const Eigen::VectorXd zeros = point.others.head(layout_.rest_motions.size());
    return pattern_(Eigen::all, layout_.rest_motions) * zeros;
}

Eigen::VectorXd TrajectoryProblem::calcResidual(std::size_t piece, const TrajectoryPoint& point) const {
    const TrajectoryPiece& at = pieces_[piece];
    const Eigen::MatrixXd measured = runs_[at.run].measured.q.middleCols(at.first, at.count);
    const Eigen::MatrixXd difference = (simulate(piece, point) - measured).colwise() + calcRestReading(point);
    return difference(rows_, Eigen::all).reshaped();
}

std::vector<Eigen::Index> TrajectoryProblem::listUnknowns(std::size_t piece) const {
    std::vector<Eigen::Index> unknowns;
    const bool loaded = runs_[pieces_[piece].run].drive.load().cols() > 0;
    for (Eigen::Index j = 0; j < layout_.startAt(0); ++j)
        if (j < layout_.loadAt() || loaded) unknowns.push_back(j);
    for (Eigen::Index j = 0; j < layout_.start_counts[piece]; ++j) unknowns.push_back(layout_.startAt(piece) + j);
    return unknowns;
}

TrajectoryTangent TrajectoryProblem::linearise(std::size_t piece, const TrajectoryPoint& point) {
    TrajectoryTangent tangent;
    tangent.unknowns = listUnknowns(piece);
    tangent.residual = calcResidual(piece, point);
    tangent.axes = rows_.size();
    tangent.jacobian.resize(tangent.residual.size(), tangent.unknowns.size());
    const double size = std::sqrt(runs_.meanSquare(pieces_[piece].run) * static_cast<double>(tangent.residual.size()));
    runParallel(tangent.unknowns.size(), [&](std::size_t column) {
        constexpr int most_trials = 4;
        constexpr double wide = 30;            // factor that the effect of a step may be off by
        constexpr double largest_step = 1e-2;  // of the scale; a piece that hardly moves shows no effect of any
        const Eigen::Index j = tangent.unknowns[column], at = column;
        if (j >= layout_.restAt() && j < layout_.loadAt()) {
            const Eigen::VectorXd reading = pattern_(rows_, layout_.rest_motions[j - layout_.restAt()]) * scale_[j];
            tangent.jacobian.col(at) = reading.replicate(pieces_[piece].count, 1);
            return;
        }
        for (int trial = 0; trial < most_trials; ++trial) {
            TrajectoryPoint moved = point;
            if (j < layout_.restAt())
                setParameter(moved.model, layout_.names[j], getParameter(point.model, layout_.names[j]) + step_[j]);
            else
                moved.others[j - layout_.restAt()] += step_[j];
            const Eigen::VectorXd difference = calcResidual(piece, moved) - tangent.residual;
            tangent.jacobian.col(at) = difference * (scale_[j] / step_[j]);
            const double effect = difference.norm() / size;
            if (effect == 0 || (effect < wide * kStepEffect && effect > kStepEffect / wide)) break;
            const double wanted = std::min(step_[j] * kStepEffect / effect, largest_step * scale_[j]);
            if (wanted == step_[j]) break;
            step_[j] = wanted;
        }
    });
    return tangent;
}

}  // namespace wems::identify
