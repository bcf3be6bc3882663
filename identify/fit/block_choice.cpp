#include "identify/fit/block_choice.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "identify/fit/solver.hpp"
#include "identify/fit/stored_equations.hpp"

namespace wems::identify {
namespace {

constexpr double least_gain = 0.02;       // of the logarithm of the determinant
constexpr double nearer_clearance = 0.6;  // of the model's
constexpr double error_level = 1e-3;      // of the elastomers' force at the clearances

/// Errors of the equations, alike in all blocks: a thousandth of the force that the mean elastomer gives at the mean
/// clearance (1 mm without stops), for moments at the connections' mean distance. Only their ratios matter, and their
/// size to what the model itself tells.
Matrix6d makeWeights(const MountModel& model) {
    double stiffness = 0, clearance = 0, arm = 0;
    int axes = 0, stops = 0;
    for (const Connection& connection : model.connections) {
        arm += connection.position.squaredNorm();
        for (const AxisLaw& law : connection.axis) {
            stiffness += law.stiffness;
            ++axes;
            for (const Stop& stop : law.stops) {
                clearance += stop.clearance;
                ++stops;
            }
        }
    }
    const double force = error_level * stiffness / axes * (stops > 0 ? clearance / stops : 1e-3);
    const double distance = std::max(1e-3, std::sqrt(arm / static_cast<double>(model.connections.size())));
    Vector6d weights;
    weights << Eigen::Vector3d::Constant(1 / force), Eigen::Vector3d::Constant(1 / (force * distance));
    return weights.asDiagonal();
}

double calcLogDeterminant(const Eigen::MatrixXd& matrix) {
    return 2 * matrix.llt().matrixLLT().diagonal().array().log().sum();
}

}  // namespace

BlockChoice::BlockChoice(const MountModel& model, const FitOptions& options, std::size_t most)
    : model_(model),
      options_(options),
      most_(std::max<std::size_t>(1, most)),
      parameters_(makeParameters(model, options.free_body)),
      weights_(makeWeights(model)) {
    const Eigen::Index count = parameters_.size();
    scale_.resize(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const Parameter& parameter = parameters_[j];
        scale_(j) = calcScale(model, parameter);
        if (parameter.kind == ParameterKind::clearance)
            stops_.push_back({parameter.connection, parameter.axis, parameter.stop});
    }
    kept_information_ = Solver::kPriorWeight * Eigen::MatrixXd::Identity(count, count);
    all_information_ = kept_information_;
}

Eigen::MatrixXd BlockChoice::calcInformation(const RunMotion& block) const {
    std::vector<RunEquations> run;
    run.push_back(makeRunEquations(block, model_, options_));
    NormalEquations equations(std::move(run));
    equations.whiten({weights_});
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(scale_.size(), scale_.size());
    for (const double share : {1.0, nearer_clearance}) {
        MountModel model = model_;
        for (Connection& connection : model.connections)
            for (AxisLaw& law : connection.axis)
                for (Stop& stop : law.stops) stop.clearance *= share;
        equations.setStops(model, stops_);
        const Eigen::MatrixXd jacobian = equations.makeJacobian(model, parameters_) * scale_.asDiagonal();
        information += 0.5 * jacobian.transpose() * equations.gram() * jacobian;
    }
    return information;
}

void BlockChoice::offer(RunMotion block) {
    Block candidate{offered_, std::move(block), {}};
    candidate.information = calcInformation(candidate.motion);
    ++offered_;
    all_information_ += candidate.information;
    if (kept_.size() < most_) {
        kept_information_ += candidate.information;
        kept_.push_back(std::move(candidate));
        return;
    }
    const Eigen::MatrixXd with = kept_information_ + candidate.information;
    double best = calcLevel() + least_gain;
    Block* leaves = nullptr;
    for (Block& kept : kept_) {
        const double exchanged = calcLogDeterminant(with - kept.information);
        if (!(exchanged > best)) continue;
        best = exchanged;
        leaves = &kept;
    }
    if (leaves == nullptr) return;
    *leaves = std::move(candidate);
    // Summed anew, so that differences leave no round-off.
    kept_information_ = Solver::kPriorWeight * Eigen::MatrixXd::Identity(scale_.size(), scale_.size());
    for (const Block& kept : kept_) kept_information_ += kept.information;
}

std::vector<RunMotion> BlockChoice::takeBlocks() {
    std::sort(kept_.begin(), kept_.end(), [](const Block& a, const Block& b) { return a.number < b.number; });
    std::vector<RunMotion> motions;
    for (Block& block : kept_) motions.push_back(std::move(block.motion));
    kept_.clear();
    return motions;
}

double BlockChoice::calcLevel() const {
    return calcLogDeterminant(kept_information_);
}

BlockChoice::Cost BlockChoice::calcCost() const {
    const auto identity = Eigen::MatrixXd::Identity(scale_.size(), scale_.size());
    const Eigen::VectorXd kept = kept_information_.llt().solve(identity).diagonal(),
                          all = all_information_.llt().solve(identity).diagonal();
    Cost cost;
    std::vector<double> ratios;
    for (Eigen::Index j = 0; j < kept.size(); ++j) {
        const double ratio = std::sqrt(kept(j) / all(j));
        ratios.push_back(ratio);
        if (ratio <= cost.largest) continue;
        cost.largest = ratio;
        cost.parameter = parameters_[j].name;
    }
    std::sort(ratios.begin(), ratios.end());
    if (!ratios.empty()) cost.median = ratios[ratios.size() / 2];
    return cost;
}

double calcFitMemory(const MountModel& model, const FitOptions& options) {
    constexpr double motion_numbers = 40, equations = 6;
    ColumnLayout layout;
    layout.axes = 3 * static_cast<int>(model.connections.size());
    layout.free_body = !options.free_body.empty();
    const auto columns = static_cast<double>(layout.count());
    const auto parameters = static_cast<double>(makeAnyParameters(model, options.free_body).size());
    return sizeof(double) * (motion_numbers + equations * (columns + parameters));
}

}  // namespace wems::identify
