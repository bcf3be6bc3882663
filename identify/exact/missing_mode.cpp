#include "identify/exact/missing_mode.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "identify/exact/leftover.hpp"
#include "identify/problem/bracket_equation.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

constexpr double kBandRatio = 0.004;     // width of a band over its frequency: well below that of a resonance
constexpr double kGridRatio = 0.03;      // spacing of the scan …
constexpr double kGridDamping = 0.02;    // … which a resonance of this damping ratio does not slip through
constexpr double kBeyond = 1.5;          // a mode above the band still shows by its flexibility
constexpr double kLargestDamping = 0.2;  // of a structure
constexpr double kSmallestDamping = 1e-3;
constexpr double kRidge = 1e-6;
constexpr int kShapeSteps = 20;
constexpr int kRefinements = 12;

/// d vec(φ pᵀ) / dp.
Eigen::MatrixXd calcShapeJacobian(const Eigen::VectorXd& p) {
    const Eigen::Index n = p.size();
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6 * n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        jacobian.block<6, 6>(6 * j, 0).diagonal().array() += p[j];
        jacobian.block<6, 1>(6 * j, j) += p.head<6>();
    }
    return jacobian;
}

Eigen::VectorXd flatten(const Eigen::VectorXd& p) {
    const Eigen::MatrixXd A = p.head<6>() * p.transpose();
    return Eigen::Map<const Eigen::VectorXd>(A.data(), A.size());
}

}  // namespace

ModalScan::ModalScan(double lowest, double highest, Eigen::Index inputs, double lever)
    : lowest_(lowest), highest_(highest), inputs_(inputs), lever_(lever) {
    bands_.resize(static_cast<std::size_t>(std::log(highest / lowest) / kBandRatio) + 1);
    for (auto& band : bands_) {
        band.normal = Eigen::MatrixXd::Zero(6 * inputs, 6 * inputs);
        band.right = Eigen::MatrixXcd::Zero(6, inputs);
    }
}

void ModalScan::add(double frequency, const Eigen::Ref<const Eigen::VectorXcd>& input, const Matrix6c& factor,
                    const Vector6c& white_residual) {
    if (frequency < lowest_ || frequency > highest_) return;
    auto& band =
        bands_[std::min(bands_.size() - 1, static_cast<std::size_t>(std::log(frequency / lowest_) / kBandRatio))];
    band.frequency += frequency;
    ++band.count;
    const Matrix6c weight = factor.adjoint() * factor;
    band.right -= factor.adjoint() * white_residual * input.adjoint();
    for (Eigen::Index j = 0; j < inputs_; ++j)
        for (Eigen::Index l = 0; l <= j; ++l)
            band.normal.block<6, 6>(6 * j, 6 * l) += (std::conj(input[j]) * input[l] * weight).real();
}

ModalGuess ModalScan::fit(double frequency, double damping_ratio) const {
    BracketMode mode;
    mode.frequency = frequency;
    mode.damping_ratio = damping_ratio;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(6 * inputs_, 6 * inputs_);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(6, inputs_);
    for (const auto& band : bands_) {
        if (band.count == 0) continue;
        const auto response = calcModalResponse(mode, kTwoPi * band.frequency / band.count);
        normal += std::norm(response) * band.normal;
        sum += (std::conj(response) * band.right).real();
    }
    normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
    const Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(sum.data(), sum.size());
    ModalGuess guess{frequency, damping_ratio, {}, 0};

    Eigen::MatrixXd regular = normal;
    regular.diagonal() *= 1 + kRidge;
    regular.diagonal().array() += 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
    const Eigen::VectorXd flat = regular.ldlt().solve(right);
    Eigen::MatrixXd A = Eigen::Map<const Eigen::MatrixXd>(flat.data(), 6, inputs_);
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(inputs_);
    scale.segment<3>(3).setConstant(lever_);
    A = scale.head<6>().asDiagonal() * A * scale.asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd u = svd.matrixU().col(0), v = svd.singularValues()[0] * svd.matrixV().col(0);
    const double square = v.head<6>().dot(u);
    if (!(square > 0)) return guess;
    Eigen::VectorXd p = v / std::sqrt(square);
    p.head<6>() = u * std::sqrt(square);
    p = p.cwiseQuotient(scale).eval();

    const auto calcGain = [&](const Eigen::VectorXd& at) {
        const Eigen::VectorXd vec = flatten(at);
        return 2 * right.dot(vec) - vec.dot(normal * vec);
    };
    double gain = calcGain(p), damping = 1e-3;
    for (int i = 0; i < kShapeSteps && damping < 1e6; ++i) {
        const Eigen::MatrixXd jacobian = calcShapeJacobian(p);
        Eigen::MatrixXd hessian = jacobian.transpose() * normal * jacobian;
        hessian.diagonal() *= 1 + damping;
        hessian.diagonal().array() += 1e-12 * hessian.diagonal().maxCoeff() + 1e-300;
        const Eigen::VectorXd next = p + hessian.ldlt().solve(jacobian.transpose() * (right - normal * flatten(p)));
        const double better = calcGain(next);
        if (!(better > gain)) {
            damping *= 10;
            continue;
        }
        const bool done = better - gain < 1e-4 * better;
        p = next;
        gain = better;
        damping *= 0.2;
        if (done) break;
    }
    guess.participation = p;
    guess.gain = std::max(0.0, gain);
    return guess;
}

ModalGuess ModalScan::refine(ModalGuess guess) const {
    double step = 0.5 * kGridRatio, factor = 2;
    for (int i = 0; i < kRefinements; ++i) {
        bool moved = false;
        for (const auto& [f, z] :
             {std::pair{1 + step, 1.0}, std::pair{1 - step, 1.0}, std::pair{1.0, factor}, std::pair{1.0, 1 / factor}}) {
            const double damping = std::clamp(guess.damping_ratio * z, kSmallestDamping, kLargestDamping);
            const auto next = fit(guess.frequency * f, damping);
            if (next.gain <= guess.gain) continue;
            guess = next;
            moved = true;
        }
        if (moved) continue;
        step *= 0.5;
        factor = std::sqrt(factor);
    }
    return guess;
}

std::vector<ModalGuess> ModalScan::findBest(std::size_t count) const {
    std::vector<ModalGuess> grid, best;
    for (double f = lowest_; f < kBeyond * highest_; f *= 1 + kGridRatio) grid.push_back(fit(f, kGridDamping));
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const bool above_left = i == 0 || grid[i].gain > grid[i - 1].gain;
        const bool above_right = i + 1 == grid.size() || grid[i].gain >= grid[i + 1].gain;
        if (grid[i].gain > 0 && above_left && above_right) best.push_back(grid[i]);
    }
    const auto byGain = [](const ModalGuess& a, const ModalGuess& b) { return a.gain > b.gain; };
    std::sort(best.begin(), best.end(), byGain);
    if (best.size() > count) best.resize(count);
    for (auto& guess : best) guess = refine(guess);
    std::sort(best.begin(), best.end(), byGain);
    return best;
}

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
