#include "identify/fit/solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "identify/fit/normal_equations.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {
namespace {

constexpr double kLeastReliability = 0.9;  // share of a direction's inner product that must not be noise
constexpr double kLeastReach = 0.1;        // share of the model's clearance below which no stop is looked for
constexpr double kLeastResidual = 1e-3;    // of the demanded force or moment: gains and positions are no better known
constexpr double kOpenError = 2;           // relative error in the largest component of a direction seen only in noise

bool sameStop(const StopTerm& a, const StopTerm& b) {
    return a.connection == b.connection && a.axis == b.axis && a.stop == b.stop;
}

bool isStopParameter(const Parameter& parameter) {
    return parameter.kind == ParameterKind::clearance || parameter.kind == ParameterKind::stop_stiffness;
}

Stop& updStop(MountModel& model, const StopTerm& term) {
    return model.connections[term.connection].axis.at(term.axis).stops.at(term.stop);
}

}  // namespace

Solver::Solver(const std::vector<RunMotion>& motions, NormalEquations& equations, std::vector<Parameter> parameters,
               const MountModel& base)
    : motions_(motions), equations_(equations), parameters_(std::move(parameters)), base_(base), model_(base) {
    for (const auto& parameter : parameters_)
        if (parameter.kind == ParameterKind::clearance)
            all_stops_.push_back({parameter.connection, parameter.axis, parameter.stop});
}

double Solver::calcReach(const StopTerm& term) const {
    const double offset = model_.connections[term.connection].axis.at(term.axis).offset;
    const bool positive = stopOf(model_, term).side == Side::positive;
    double reach = -1;
    for (const auto& run : equations_.runs()) {
        const AxisHistory& history = run.axes[term.historyIndex()];
        reach = std::max(reach, positive ? history.largest + offset : -history.smallest - offset);
    }
    return reach;
}

Eigen::MatrixXd Solver::makeNoiseProducts() const {
    const auto& layout = equations_.layout();
    const auto& stops = equations_.stops();
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(equations_.gram().rows(), equations_.gram().cols());
    for (std::size_t r = 0; r < noise_.size(); ++r) {
        products.topLeftCorner(layout.count(), layout.count()) += noise_[r];
        for (std::size_t s = 0; s < stops.size(); ++s) {
            // A stop's column follows the displacement as the elastomer's does, as long as there is contact.
            const double share = equations_.stopColumn(r, s).contact_share;
            const Eigen::RowVectorXd row = share * noise_[r].row(layout.stiffness(stops[s].historyIndex()));
            const int value = equations_.valueColumn(s);
            products.row(value).head(layout.count()) += row;
            products.col(value).head(layout.count()) += row.transpose();
            products(value, value) += row(layout.stiffness(stops[s].historyIndex()));
        }
    }
    return products;
}

LinearSystem Solver::makeSystem(bool free_clearances) const {
    LinearSystem system;
    std::vector<Parameter> taking_part;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
        const Parameter& parameter = parameters_[p];
        if (isStopParameter(parameter)) {
            const StopTerm term{parameter.connection, parameter.axis, parameter.stop};
            const auto& stops = equations_.stops();
            if (std::find(stops.begin(), stops.end(), term) == stops.end()) continue;
            if (parameter.kind == ParameterKind::clearance && !free_clearances) continue;
        }
        system.parameters.push_back(static_cast<int>(p));
        taking_part.push_back(parameter);
    }
    const Eigen::Index count = taking_part.size();
    system.scale.resize(count);
    Eigen::VectorXd distance(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const Parameter& parameter = taking_part[j];
        system.scale(j) = calcScale(base_, parameter);
        distance(j) = (getParameter(model_, parameter.name) - getParameter(base_, parameter.name)) / system.scale(j);
    }
    const Eigen::MatrixXd jacobian = equations_.makeJacobian(model_, taking_part) * system.scale.asDiagonal();
    const Eigen::MatrixXd& gram = equations_.gram();
    const Eigen::MatrixXd noise = makeNoiseProducts();
    const Eigen::MatrixXd prior = kPriorWeight * Eigen::MatrixXd::Identity(count, count);
    system.information = jacobian.transpose() * gram * jacobian;
    const Eigen::MatrixXd seen = system.information + prior;
    const Eigen::MatrixXd true_part = seen - jacobian.transpose() * noise * jacobian;
    system.gradient =
        jacobian.transpose() * ((gram - noise) * equations_.makeCoefficients(model_)) + kPriorWeight * distance;

    system.column_norm = seen.diagonal().cwiseSqrt();
    const Eigen::LLT<Eigen::MatrixXd> cholesky(seen);
    const Eigen::MatrixXd half = cholesky.matrixL().solve(true_part);
    const Eigen::MatrixXd reliability = cholesky.matrixL().solve(half.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (reliability + reliability.transpose()));
    const Eigen::MatrixXd directions = cholesky.matrixU().solve(eigen.eigenvectors());
    system.inverse = Eigen::MatrixXd::Zero(count, count);
    system.open = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const double share = eigen.eigenvalues()(j);
        const Eigen::VectorXd direction = directions.col(j);
        const double largest = direction.cwiseAbs().maxCoeff();
        if (share > kLeastReliability)
            system.inverse += direction * direction.transpose() / share;
        else
            system.open += direction * direction.transpose() * std::pow(kOpenError / largest, 2);
    }
    return system;
}

double Solver::calcObjective() const {
    const Eigen::VectorXd coefficients = equations_.makeCoefficients(model_);
    double objective = coefficients.dot((equations_.gram() - makeNoiseProducts()) * coefficients);
    for (const auto& parameter : parameters_) {
        const double distance =
            (getParameter(model_, parameter.name) - getParameter(base_, parameter.name)) / calcScale(base_, parameter);
        objective += kPriorWeight * distance * distance;
    }
    return objective;
}

double Solver::calcResidualSquares() const {
    const Eigen::VectorXd coefficients = equations_.makeCoefficients(model_);
    return coefficients.dot(equations_.gram() * coefficients);
}

double Solver::calcNoiseSquares() const {
    const Eigen::VectorXd coefficients = equations_.makeCoefficients(model_);
    return coefficients.dot(makeNoiseProducts() * coefficients);
}

Eigen::VectorXd Solver::getParameters(const LinearSystem& system) const {
    Eigen::VectorXd values(system.scale.size());
    for (Eigen::Index j = 0; j < values.size(); ++j)
        values(j) = getParameter(model_, parameters_[system.parameters[j]].name);
    return values;
}

void Solver::setParameters(const LinearSystem& system, const Eigen::VectorXd& values) {
    for (Eigen::Index j = 0; j < values.size(); ++j)
        setParameter(model_, parameters_[system.parameters[j]].name, values(j));
}

void Solver::solveLinear() {
    for (int pass = 0; pass < 2; ++pass) {  // the second for the centre of gravity, which enters quadratically
        const LinearSystem system = makeSystem(false);
        setParameters(system, getParameters(system) - system.scale.cwiseProduct(system.inverse * system.gradient));
        if (!equations_.layout().free_body) break;
    }
}

void Solver::solveAll() {
    constexpr int most_iterations = 25;
    constexpr double converged = 1e-7;  // relative step
    double objective = calcObjective();
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        const LinearSystem system = makeSystem(true);
        const Eigen::VectorXd step = -system.inverse * system.gradient;
        const Eigen::VectorXd start = getParameters(system);
        double length = 1;
        for (int halving = 0; halving < 8; ++halving, length /= 2) {
            Eigen::VectorXd values = start + length * system.scale.cwiseProduct(step);
            for (Eigen::Index j = 0; j < values.size(); ++j) {
                const auto& parameter = parameters_[system.parameters[j]];
                if (parameter.kind != ParameterKind::clearance) continue;
                const double reach = calcReach({parameter.connection, parameter.axis, parameter.stop});
                values(j) = std::clamp(values(j), 0.26 * reach, 0.999 * reach);
            }
            setParameters(system, values);
            equations_.updateStops(model_);
            const double trial = calcObjective();
            if (trial <= objective * (1 + 1e-12) || halving == 7) {
                objective = trial;
                break;
            }
        }
        if (length * step.cwiseAbs().maxCoeff() < converged) break;
    }
}

bool Solver::scanStop(const StopTerm& term) {
    const double reach = calcReach(term);
    if (reach < kLeastReach * stopOf(base_, term).clearance) return false;
    const std::vector<StopTerm> others = equations_.stops();
    const double without = calcObjective();
    const MountModel before = model_;

    auto with = others;
    with.push_back(term);
    std::vector<double> candidates;
    for (int step = 0; step < 8; ++step) candidates.push_back((0.35 + 0.08 * step) * reach);
    const double known = stopOf(base_, term).clearance;
    if (known > 0.3 * reach && known < 0.99 * reach) candidates.push_back(known);
    double best = without - kNoticed;
    MountModel best_model = before;
    bool found = false;
    updStop(model_, term).clearance = candidates.front();
    equations_.setStops(model_, with);
    for (const double clearance : candidates) {
        updStop(model_, term).clearance = clearance;
        equations_.updateStops(model_);
        solveLinear();
        const double objective = calcObjective();
        const bool same_sign = stopOf(model_, term).stiffness * stopOf(base_, term).stiffness > 0;
        if (objective >= best || !same_sign) continue;
        best = objective;
        best_model = model_;
        found = true;
    }
    model_ = best_model;
    if (found)
        equations_.updateStops(model_);
    else
        equations_.setStops(model_, others);
    return found;
}

void Solver::scanStops() {
    // Stops on one side often move together, so that what the first takes is shared with those found after it.
    constexpr int most_rounds = 3;
    std::size_t before = 0;
    for (int round = 0; round < most_rounds; ++round) {
        for (const StopTerm& term : all_stops_) {
            const auto& stops = equations_.stops();
            if (std::none_of(stops.begin(), stops.end(), [&](const StopTerm& s) { return sameStop(s, term); }))
                scanStop(term);
        }
        if (equations_.stops().size() == before) return;
        before = equations_.stops().size();
        solveAll();
    }
}

void Solver::updateWeights(bool from_residual) {
    std::vector<Matrix6d> transforms;
    for (std::size_t r = 0; r < equations_.runs().size(); ++r) {
        const RunEquations& run = equations_.runs()[r];
        Matrix6d covariance = Matrix6d::Zero();
        Eigen::VectorXd signal;
        if (from_residual) {
            signal = calcResidual(r);
        } else {
            signal = run.columns.col(run.layout.known());
            if (run.layout.free_body) signal = run.columns.leftCols(11) * makeCoefficients(run.layout, model_).head(11);
        }
        const Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>> rows(signal.data(), 6, run.outputs);
        covariance = rows * rows.transpose() / std::max(1, run.outputs);
        // A direction without any signal would get infinite weight.
        const double floor = 1e-12 * covariance.topLeftCorner<3, 3>().trace();
        const double moment_floor = 1e-12 * covariance.bottomRightCorner<3, 3>().trace();
        if (!from_residual) {
            // Forces alike and moments alike: an equation in which little happens must not decide which stops there
            // are.
            const double force = covariance.topLeftCorner<3, 3>().trace() / 3;
            const double moment = covariance.bottomRightCorner<3, 3>().trace() / 3;
            covariance.setZero();
            covariance.diagonal() << force, force, force, moment, moment, moment;
        }
        for (int e = 0; e < 6; ++e) covariance(e, e) += (e < 3 ? floor : moment_floor) + 1e-30;
        if (from_residual) {
            // Nor must an equation whose residual is round-off: no recording is that exact.
            const Matrix6d since = equations_.whitening(r) * first_whitening_[r].inverse();
            covariance += kLeastResidual * kLeastResidual * since * since.transpose();
        }
        transforms.push_back(covariance.llt().matrixL().solve(Matrix6d::Identity()));
    }
    const auto stops = equations_.stops();
    equations_.whiten(transforms);
    if (!from_residual) first_whitening_ = transforms;
    equations_.setStops(model_, stops);
    noise_.clear();
    for (std::size_t r = 0; r < equations_.runs().size(); ++r)
        noise_.push_back(calcNoiseProducts(motions_[r], model_, equations_.runs()[r], equations_.whitening(r)));
}

void Solver::run() {
    updateWeights(false);
    solveLinear();
    scanStops();
    updateWeights(true);
    solveAll();
    scanStops();
    updateWeights(true);
    solveAll();
}

void Solver::removeStop(const Parameter& of_stop) {
    const StopTerm term{of_stop.connection, of_stop.axis, of_stop.stop};
    auto stops = equations_.stops();
    stops.erase(std::remove_if(stops.begin(), stops.end(), [&](const StopTerm& s) { return sameStop(s, term); }),
                stops.end());
    updStop(model_, term) = stopOf(base_, term);
    equations_.setStops(model_, stops);
    solveAll();
}

Eigen::VectorXd Solver::calcResidual(std::size_t run) const {
    return equations_.apply(run, equations_.makeCoefficients(model_));
}

Eigen::MatrixXd Solver::makeSensitivityColumns(const LinearSystem& system) const {
    std::vector<Parameter> taking_part;
    for (const int p : system.parameters) taking_part.push_back(parameters_[p]);
    return equations_.makeJacobian(model_, taking_part) * system.scale.asDiagonal();
}

RowMatrix Solver::calcSensitivity(std::size_t run, const LinearSystem& system) const {
    return equations_.apply(run, makeSensitivityColumns(system));
}

double Solver::findNoticedClearance(const StopTerm& term) {
    const double reach = calcReach(term);
    if (reach < kLeastReach * stopOf(base_, term).clearance) return 0;
    const MountModel before = model_;
    const auto others = equations_.stops();
    auto with = others;
    with.push_back(term);
    double noticed = 0;
    for (int step = 0; step < 17 && noticed == 0; ++step) {
        const double share = 0.98 - 0.04 * step;
        updStop(model_, term).clearance = share * reach;
        equations_.setStops(model_, with);
        const LinearSystem system = makeSystem(false);
        for (std::size_t j = 0; j < system.parameters.size(); ++j) {
            const auto& parameter = parameters_[system.parameters[j]];
            if (parameter.kind != ParameterKind::stop_stiffness ||
                !sameStop(term, {parameter.connection, parameter.axis, parameter.stop}))
                continue;
            const Eigen::Index k = j;
            if ((system.inverse(k, k) + system.open(k, k)) * kNoticed < 1)
                noticed = share * reach;  // for the model's own stiffness
        }
    }
    model_ = before;
    equations_.setStops(model_, others);
    return noticed;
}

}  // namespace wems::identify
