#include "identify/updating/missing_mode.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "identify/catalogue/modal_scan.hpp"
#include "identify/problem/lineariser.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

constexpr double kRigid = 0.01;   // of the load point's motion, for what is not that of a rigid interface
constexpr double kDriven = 1e-3;  // share of the strongest direction's power from which on a direction is driven

/// Point that moves as the load point does in all modes: load = u + r × p, by least squares.
struct LoadPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d scatter = Eigen::Vector3d::Zero();  // RMS of what the modes' load points leave
    bool rigid = false;
    bool determined = false;  // the modes turn enough to tell where it is
};

LoadPoint findLoadPoint(const std::vector<BracketMode>& modes) {
    Eigen::MatrixXd crosses(3 * modes.size(), 3);
    Eigen::VectorXd right(crosses.rows());
    double load = 0, shaped = 0;
    for (std::size_t j = 0; j < modes.size(); ++j) {
        const Eigen::Index row = 3 * j;
        crosses.middleRows<3>(row) = crossMatrix(modes[j].rotation);
        right.segment<3>(row) = modes[j].load_translation - modes[j].translation;
        load += modes[j].load_translation.squaredNorm();
        if (!modes[j].load_translation.isZero(0.0)) ++shaped;
    }
    LoadPoint point;
    const auto decomposition = crosses.completeOrthogonalDecomposition();
    point.position = decomposition.solve(right);
    point.determined = decomposition.rank() == 3;
    const Eigen::VectorXd left = crosses * point.position - right;
    point.rigid = left.squaredNorm() < kRigid * kRigid * load;
    // Below that it is round-off of the solution, and no freedom.
    const double rounding = std::sqrt(std::numeric_limits<double>::epsilon() * load);
    if (left.norm() > rounding)
        point.scatter = (left.reshaped(3, modes.size()).rowwise().squaredNorm() / shaped).cwiseSqrt();
    return point;
}

/// Directions in which a source acted that the runs together tell apart, the strongest first.
std::vector<int> listDriven(const std::vector<std::unique_ptr<Lineariser>>& runs,
                            Eigen::Matrix3Xd OpenLoopRun::*source) {
    Eigen::Matrix3d power = Eigen::Matrix3d::Zero();
    for (const auto& run : runs) {
        const Eigen::Matrix3Xd& history = run->run().*source;
        power += history * history.transpose();
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
struct InputLayout {
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
};

}  // namespace

std::optional<MissingMode> findMissingMode(const std::vector<TestRun>& runs, const SensorLayout& layout,
                                           const TestState& state) {
    std::vector<std::unique_ptr<Lineariser>> at;
    double lowest = std::numeric_limits<double>::infinity(), highest = 0;
    for (const TestRun& run : runs) {
        auto own = std::make_unique<Lineariser>(run, layout, state);
        if (!own->hasBracket() || own->spectra().binCount() == 0) continue;
        own->prepareColumns();
        lowest = std::min(lowest, own->spectra().frequency(0));
        highest = std::max(highest, own->spectra().frequency(own->spectra().binCount() - 1));
        at.push_back(std::move(own));
    }
    if (at.empty()) return std::nullopt;
    InputLayout inputs;
    inputs.load_point = findLoadPoint(state.model.bracket);
    if (!inputs.load_point.rigid) inputs.load = listDriven(at, &OpenLoopRun::load);
    inputs.base = listDriven(at, &OpenLoopRun::base);
    double lever = 0;
    for (const auto& connection : state.model.connections) lever = std::max(lever, connection.position.norm());
    ModalScan scan(lowest, highest, inputs.size(), lever > 0 ? lever : 1.0);
    const Eigen::MatrixXd map = inputs.calcMap();
    for (const auto& own : at)
        for (Eigen::Index b = 0; b < own->spectra().binCount(); ++b)
            scan.add(own->spectra().frequency(b), map.cast<std::complex<double>>() * own->inputs().col(b),
                     own->noise().whitener(b).bottomRightCorner<6, 6>(), own->residual().col(b).tail<6>());
    const auto guesses = scan.findBest(1);
    if (guesses.empty()) return std::nullopt;
    MissingMode missing{inputs.makeMode(guesses.front()), std::nullopt, inputs.load_point.scatter};
    if (inputs.load_point.rigid && inputs.load_point.determined) {
        missing.load_by_shape.emplace();
        *missing.load_by_shape << Eigen::Matrix3d::Identity(), -crossMatrix(inputs.load_point.position);
    }
    return missing;
}

double calcModeReach(const BracketMode& mode, const Unknown& row) {
    if (row.kind == UnknownKind::mode) return row.second == 0 ? 0.2 * mode.frequency : 2 * mode.damping_ratio;
    const Eigen::Vector3d parts[] = {mode.translation, mode.rotation, mode.load_translation, mode.base_participation};
    const double own = parts[row.second / 3].cwiseAbs().maxCoeff();
    return own > 0 ? own : row.reach;
}

Direction makeModeDirection(const MissingMode& missing, const Unknown& row, int index) {
    constexpr int kLoad = 6;  // entries of the interface before those of the load
    const int entry = row.second;
    if (row.kind != UnknownKind::shape || !missing.load_by_shape || entry >= kLoad + 3) return {{index, row.reach}};
    if (entry >= kLoad) {
        const double scatter = missing.load_scatter[entry - kLoad];
        return scatter > 0 ? Direction{{index, scatter}} : Direction{};
    }
    Direction direction{{index, row.reach}};
    for (int a = 0; a < 3; ++a) {
        const double follows = (*missing.load_by_shape)(a, entry);
        if (follows != 0) direction.emplace_back(index - entry + kLoad + a, follows * row.reach);
    }
    return direction;
}

}  // namespace wems::identify
