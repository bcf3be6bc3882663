#include "identify/residual/residual_problem.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/motion/noise_estimate.hpp"

namespace wems::identify {
namespace {

// With these steps and looks 138 of 140 drawn component tests are right (VALIDATION.md); other values were not tried.
constexpr int kMostMarquardtSteps = 15;  // of Levenberg and Marquardt
constexpr double kSettled = 0.05;        // log evidence that a further step would still change
constexpr double kLooks[] = {-1, -0.5, -0.2, -0.05, 0.05, 0.2, 0.5, 1};  // of a direction's reach
constexpr double kLeastSquare = 1e-20;                                   // of the signal's: a law without noise

}  // namespace

Eigen::VectorXd ResidualProblem::believedValues() const {
    Eigen::VectorXd values(table_.size());
    for (std::size_t i = 0; i < table_.size(); ++i) values[i] = table_[i].believed;
    return values;
}

double ResidualProblem::countSamples(const Eigen::VectorXd& residual) {
    return std::max(2.0, static_cast<double>(residual.size()) / calcCorrelationLength(residual));
}

ResidualFit ResidualProblem::fit(const HypothesisSet& set, double samples, const Eigen::VectorXd& start,
                                 const std::vector<std::pair<int, double>>& held) const {
    const Eigen::Index rows = table_.size();
    Eigen::VectorXd base = believedValues();
    std::vector<char> is_held(table_.size(), 0);
    for (const auto& [row, value] : held) is_held[row] = 1;
    // Columns of V: tolerances, then directions.
    std::vector<Eigen::VectorXd> columns;
    double odds = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
        const double deviation = table_[i].deviation;
        if (deviation > 0 && !is_held[i]) columns.emplace_back(deviation * Eigen::VectorXd::Unit(rows, i));
    }
    const Eigen::Index tolerances = columns.size();
    Eigen::VectorXd values = start;
    for (const int h : set) {
        const Hypothesis& hypothesis = hypotheses_[h];
        odds += hypothesis.log_prior;
        for (const auto& [row, value] : hypothesis.start) base[row] = value;
        for (const Direction& direction : hypothesis.directions) {
            Eigen::VectorXd column = Eigen::VectorXd::Zero(rows);
            for (const auto& [row, weight] : direction)
                if (!is_held[row]) column[row] += weight;
            if (!column.isZero(0.0)) columns.push_back(column);
        }
    }
    for (const auto& [row, value] : held) base[row] = value;
    Eigen::MatrixXd V(rows, columns.size());
    for (std::size_t j = 0; j < columns.size(); ++j) V.col(j) = columns[j];

    const auto clamp = [&](Eigen::VectorXd at) {
        for (Eigen::Index i = 0; i < rows; ++i) {
            const Unknown& row = table_[i];
            at[i] = std::clamp(at[i], row.least, row.most);
        }
        return at;
    };
    // What the start holds of the set's own freedoms.
    Eigen::VectorXd z = Eigen::VectorXd::Zero(V.cols());
    if (V.cols() > 0) {
        const Eigen::MatrixXd normal = V.transpose() * V;
        Eigen::VectorXd scale = normal.diagonal().cwiseSqrt();
        const Eigen::MatrixXd scaled = V * scale.cwiseInverse().asDiagonal();
        Eigen::VectorXd difference = start - base;
        for (const int h : set)  // begins anew where it has a start of its own, unless it is there already
            for (const auto& [row, value] : hypotheses_[h].start)
                if (start[row] == table_[row].believed) difference[row] = 0;
        z = (scaled.transpose() * scaled + 1e-9 * Eigen::MatrixXd::Identity(V.cols(), V.cols()))
                .ldlt()
                .solve(scaled.transpose() * difference)
                .cwiseQuotient(scale);
    }
    const double total = calcSignalSquare();
    const auto squareOf = [&](const Eigen::VectorXd& residual) {
        return std::max(residual.squaredNorm(), kLeastSquare * total);
    };
    const auto objective = [&](const Eigen::VectorXd& residual, const Eigen::VectorXd& at) {
        return samples * std::log(squareOf(residual)) + at.squaredNorm();
    };
    ResidualFit fit;
    fit.set = set;
    fit.held = held;
    fit.samples = samples;
    values = clamp(base + V * z);
    Eigen::VectorXd residual = calcResidual(values);
    Eigen::MatrixXd J(residual.size(), V.cols());
    const auto differentiate = [&] {
        std::vector<char> needed(table_.size(), 0);
        for (Eigen::Index i = 0; i < rows; ++i) needed[i] = !V.row(i).isZero(0.0);
        J.setZero();
        for (Eigen::Index i = 0; i < rows; ++i) {
            if (!needed[i]) continue;
            const Unknown& row = table_[i];
            Eigen::VectorXd moved = values;
            moved[i] += moved[i] + row.step <= row.most ? row.step : -row.step;
            const Eigen::VectorXd slope = (residual - calcResidual(moved)) / (moved[i] - values[i]);
            J += slope * V.row(i);
        }
    };
    // A law that is far off may have no slope that leads back: a direction that has not moved
    // yet is looked along first.
    for (Eigen::Index j = tolerances; j < V.cols(); ++j) {
        if (z[j] != 0) continue;
        Eigen::VectorXd best = z;
        double least = objective(residual, z);
        for (const double part : kLooks) {
            Eigen::VectorXd trial = z;
            trial[j] = part;
            const Eigen::VectorXd at = clamp(base + V * trial);
            Eigen::VectorXd left = calcResidual(at);
            const double cost = objective(left, trial);
            if (!(cost < least)) continue;
            least = cost;
            best = trial;
            values = at;
            residual = std::move(left);
        }
        z = best;
    }
    double damping = 1e-3;
    bool fresh = false;
    for (int step = 0; step < kMostMarquardtSteps && V.cols() > 0; ++step) {
        differentiate();
        fresh = true;
        const double weight = samples / squareOf(residual), here = objective(residual, z);
        Eigen::MatrixXd H = weight * (J.transpose() * J);
        H.diagonal().array() += 1;
        const Eigen::VectorXd g = weight * (J.transpose() * residual) - z;
        bool moved = false;
        double gained = 0;
        for (int attempt = 0; attempt < 6; ++attempt, damping *= 8) {
            Eigen::MatrixXd damped = H;
            damped.diagonal() *= 1 + damping;
            const Eigen::VectorXd next = z + damped.ldlt().solve(g);
            if (!next.allFinite()) continue;
            const Eigen::VectorXd at = clamp(base + V * next);
            Eigen::VectorXd left = calcResidual(at);
            gained = here - objective(left, next);
            if (!(gained > 0)) continue;
            z = next;
            values = at;
            residual = std::move(left);
            damping = std::max(1e-6, damping / 10);
            moved = true;
            fresh = false;
            break;
        }
        if (!moved || gained < kSettled) break;
    }
    if (!fresh && V.cols() > 0) differentiate();
    fit.sum_of_squares = squareOf(residual);
    const double weight = samples / fit.sum_of_squares;
    Eigen::MatrixXd H = weight * (J.transpose() * J);
    H.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    const Eigen::MatrixXd root = factor.matrixL();
    fit.log_evidence = -0.5 * objective(residual, z) - root.diagonal().array().log().sum() + odds;
    fit.covariance = V.cols() > 0 ? Eigen::MatrixXd(V * factor.solve(Eigen::MatrixXd(V.transpose())))
                                  : Eigen::MatrixXd(Eigen::MatrixXd::Zero(rows, rows));
    fit.values = std::move(values);
    fit.residual = std::move(residual);
    fit.slopes = std::move(J);
    return fit;
}

double ResidualProblem::predictGain(const ResidualFit& fit, int index) const {
    const Hypothesis& hypothesis = hypotheses_[index];
    std::vector<Eigen::VectorXd> columns;
    double least = fit.sum_of_squares;  // where the laws themselves are looked along
    for (const Direction& direction : hypothesis.directions) {
        Eigen::VectorXd moved = fit.values;
        for (const auto& [row, value] : hypothesis.start) moved[row] = value;
        for (const double part : kLooks) {
            Eigen::VectorXd looked = moved;
            for (const auto& [row, weight] : direction) {
                const Unknown& number = table_[row];
                looked[row] = std::clamp(looked[row] + part * weight, number.least, number.most);
            }
            least = std::min(least, calcResidual(looked).squaredNorm());
        }
        for (const auto& [row, weight] : direction) {
            const Unknown& number = table_[row];
            const bool started = std::any_of(hypothesis.start.begin(), hypothesis.start.end(),
                                             [row = row](const auto& start) { return start.first == row; });
            if (!started) moved[row] = std::clamp(moved[row] + 0.1 * weight, number.least, number.most);
        }
        Eigen::VectorXd column = fit.residual - calcResidual(moved);
        if (!column.isZero(0.0)) columns.push_back(std::move(column));
    }
    if (columns.empty()) return -std::numeric_limits<double>::infinity();
    Eigen::MatrixXd C(fit.residual.size(), columns.size());
    for (std::size_t j = 0; j < columns.size(); ++j) C.col(j) = columns[j].normalized();
    // Beside what the present unknowns follow.
    const double weight = fit.samples / fit.sum_of_squares;
    if (fit.slopes.cols() > 0) {
        Eigen::MatrixXd H = weight * (fit.slopes.transpose() * fit.slopes);
        H.diagonal().array() += 1;
        C -= fit.slopes * H.llt().solve(Eigen::MatrixXd(weight * (fit.slopes.transpose() * C)));
    }
    Eigen::MatrixXd own = C.transpose() * C;
    const Eigen::VectorXd right = C.transpose() * fit.residual;
    own.diagonal().array() += 1e-9;  // columns that are alike share what they take
    const double taken = std::min(right.dot(own.ldlt().solve(right)), (1 - 1e-12) * fit.sum_of_squares);
    const double left = std::max(kLeastSquare * calcSignalSquare(), std::min(least, fit.sum_of_squares - taken));
    const double occam = 0.5 * static_cast<double>(columns.size()) * std::log(std::max(1.0, fit.samples));
    // What the tolerances cost that the hypothesis would lift.
    double lifted = 0;
    for (const Direction& direction : hypothesis.directions)
        for (const auto& [row, reach] : direction) {
            const Unknown& number = table_[row];
            const double off = fit.values[row] - number.believed, variance = number.deviation * number.deviation;
            if (variance > 0) lifted += 0.5 * off * off * (1 / variance - 1 / (variance + reach * reach));
        }
    return -0.5 * fit.samples * std::log(left / fit.sum_of_squares) - occam + lifted + hypothesis.log_prior;
}

}  // namespace wems::identify
