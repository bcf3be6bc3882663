#include "identify/diagnose/missing_mode.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "identify/diagnose/leftover.hpp"
#include "identify/diagnose/modal_scan.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

constexpr double kAsksForMode = 0.5;  // the residual above the noise, per value
constexpr double kRigid = 0.01;       // of the load point's motion, for what is not that of a rigid interface
constexpr double kDriven = 1e-3;      // share of the strongest direction's power from which on a direction is driven
constexpr std::size_t kStarts = 3;

/// Point that moves as the load point does in all modes: load = u + r × p, by least squares.
struct LoadPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    bool rigid = false;
};

LoadPoint findLoadPoint(const std::vector<BracketMode>& modes) {
    Eigen::MatrixXd crosses(3 * modes.size(), 3);
    Eigen::VectorXd right(crosses.rows());
    double load = 0;
    for (std::size_t j = 0; j < modes.size(); ++j) {
        const auto row = 3 * static_cast<Eigen::Index>(j);
        crosses.middleRows<3>(row) = crossMatrix(modes[j].rotation);
        right.segment<3>(row) = modes[j].load_translation - modes[j].translation;
        load += modes[j].load_translation.squaredNorm();
    }
    LoadPoint point;
    point.position = crosses.completeOrthogonalDecomposition().solve(right);
    point.rigid = (crosses * point.position - right).squaredNorm() < kRigid * kRigid * load;
    return point;
}

/// Directions in which a source acted that the runs together tell apart, the strongest first.
std::vector<int> listDriven(const OpenLoopProblem& problem, Eigen::Matrix3Xd OpenLoopRun::*source) {
    Eigen::Matrix3d power = Eigen::Matrix3d::Zero();
    for (std::size_t r = 0; r < problem.runs().size(); ++r) {
        const Eigen::Matrix3Xd& history = problem.runs()[r].*source;
        if (problem.hasBracket(r)) power += history * history.transpose();
    }
    std::vector<int> axes;
    const double largest = power.diagonal().maxCoeff();
    if (!(largest > 0)) return axes;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(power);
    const auto rank = (solver.eigenvalues().array() > kDriven * largest).count();
    axes = {0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&](int a, int b) { return power(a, a) > power(b, b); });
    axes.resize(rank);
    return axes;
}

/// The inputs of a scan as rows of the twelve of BracketEquation::calcInputs(), and back.
struct Layout {
    LoadPoint load_point;
    std::vector<int> load, base;

    Eigen::Index size() const { return 6 + static_cast<Eigen::Index>(load.size() + base.size()); }

    Eigen::MatrixXd calcMap() const {
        Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size(), 12);
        map.leftCols<6>().topRows<6>().setIdentity();
        // What no parameter of its own takes acts as on a rigid interface: force, and moment p × force.
        map.block<3, 3>(0, 6).setIdentity();
        map.block<3, 3>(3, 6) = crossMatrix(load_point.position);
        Eigen::Index row = 6;
        for (const int axis : load) {
            map.col(6 + axis).setZero();
            map(row++, 6 + axis) = 1;
        }
        for (const int axis : base) map(row++, 9 + axis) = 1;
        return map;
    }

    BracketMode makeMode(const ModalGuess& guess) const {
        const Eigen::VectorXd p = calcMap().transpose() * guess.participation;
        // Of the two signs, the one with the largest component positive.
        Eigen::Index largest = 0;
        p.head<3>().cwiseAbs().maxCoeff(&largest);
        const double sign = p[largest] < 0 ? -1 : 1;
        BracketMode mode;
        mode.frequency = guess.frequency;
        mode.damping_ratio = guess.damping_ratio;
        mode.translation = sign * p.head<3>();
        mode.rotation = sign * p.segment<3>(3);
        mode.load_translation = sign * p.segment<3>(6);
        mode.base_participation = sign * p.tail<3>();
        return mode;
    }

    std::vector<Knob> makeKnobs(int row) const {
        const std::string prefix = std::to_string(row) + ".";
        std::vector<Knob> knobs{makeKnob(prefix + "frequency"), makeKnob(prefix + "damping_ratio")};
        for (const char* name : {"ux", "uy", "uz", "rx", "ry", "rz"}) {
            knobs.push_back(makeKnob(prefix + name));
            if (load.empty())
                knobs.back().load_point = Knob::RigidLoadPoint{static_cast<std::size_t>(row - 1), load_point.position};
        }
        for (const int axis : load) knobs.push_back(makeKnob(prefix + "load.u" + "xyz"[axis]));
        for (const int axis : base) knobs.push_back(makeKnob(prefix + "base.u" + "xyz"[axis]));
        return knobs;
    }
};

void scanRun(const OpenLoopProblem& problem, std::size_t r, const MountModel& model, const Eigen::VectorXf& residual,
             const Layout& layout, ModalScan& scan) {
    const Whitening& whitening = problem.whitening(r);
    const Eigen::MatrixXd histories = layout.calcMap() * problem.bracket(r).calcInputs(model);
    Eigen::MatrixXcd inputs(histories.rows(), whitening.binCount());
    for (Eigen::Index i = 0; i < histories.rows(); ++i)
        inputs.row(i) = whitening.calcSpectrum(histories.row(i).transpose()).transpose().cast<std::complex<double>>();
    std::vector<Eigen::MatrixXcf> columns;
    for (Eigen::Index i = 0; i < 6; ++i)
        columns.push_back(whitening.whitenDirection(Equation::bracket, Eigen::Matrix<double, 6, 1>::Unit(i)));
    const Eigen::Index first = problem.offset(r) + whitening.mountSize();
    for (Eigen::Index b = 0; b < whitening.binCount(); ++b) {
        ModalScan::Matrix6c factor;
        ModalScan::Vector6c white;
        for (Eigen::Index i = 0; i < 6; ++i) {
            factor.col(i) = columns[i].col(b).cast<std::complex<double>>();
            white[i] = {static_cast<double>(residual[first + 12 * b + i]),
                        static_cast<double>(residual[first + 12 * b + 6 + i])};
        }
        scan.add(whitening.frequency(b), inputs.col(b), factor, white);
    }
}

}  // namespace

std::vector<Candidate> makeMissingMode(const OpenLoopProblem& problem, const MountModel& model,
                                       const WhiteVector& residual) {
    if (calcBracketExcess(problem, residual) < kAsksForMode) return {};
    Layout layout;
    layout.load_point = findLoadPoint(model.bracket);
    if (!layout.load_point.rigid) layout.load = listDriven(problem, &OpenLoopRun::load);
    layout.base = listDriven(problem, &OpenLoopRun::base);
    double lever = 0;
    for (const auto& connection : model.connections) lever = std::max(lever, connection.position.norm());
    double lowest = 1e9, highest = 0;
    for (std::size_t r = 0; r < problem.runs().size(); ++r) {
        const auto& whitening = problem.whitening(r);
        lowest = std::min(lowest, whitening.frequency(0));
        highest = std::max(highest, whitening.frequency(whitening.binCount() - 1));
    }
    ModalScan scan(lowest, highest, layout.size(), lever > 0 ? lever : 1.0);
    const Eigen::VectorXf values = problem.removeCalibration(residual);
    for (std::size_t r = 0; r < problem.runs().size(); ++r)
        if (problem.hasBracket(r)) scanRun(problem, r, model, values, layout, scan);
    const auto guesses = scan.findBest(kStarts);
    if (guesses.empty()) return {};

    const int row = static_cast<int>(model.bracket.size()) + 1;
    Candidate candidate{"bracket_mode", {"bracket"}, layout.makeKnobs(row), {}, {}, 0};
    for (const auto& guess : guesses) {
        candidate.new_mode = Candidate::NewMode{row, layout.makeMode(guess)};
        MountModel extended = model;
        while (static_cast<int>(extended.bracket.size()) < row) extended.bracket.push_back(candidate.new_mode->mode);
        candidate.starts.emplace_back();
        for (const auto& knob : candidate.knobs) candidate.starts.back().push_back(knob.get(extended));
    }
    candidate.new_mode = Candidate::NewMode{row, layout.makeMode(guesses.front())};
    return {candidate};
}

}  // namespace wems::identify
