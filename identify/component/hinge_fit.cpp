#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/component/block_regression.hpp"

namespace wems::identify {
namespace {

double calcHinge(const Hinge& hinge, double q) {
    const double beyond = q - hinge.position;
    return hinge.side > 0 ? std::max(beyond, 0.0) : std::min(beyond, 0.0);
}

Eigen::MatrixXd makeColumns(const Eigen::MatrixXd& base, const Eigen::VectorXd& q, const std::vector<Hinge>& hinges) {
    const Eigen::Index m = hinges.size();
    Eigen::MatrixXd X(base.rows(), base.cols() + m);
    X.leftCols(base.cols()) = base;
    for (Eigen::Index j = 0; j < m; ++j) {
        const auto& hinge = hinges[j];
        for (Eigen::Index i = 0; i < q.size(); ++i) X(i, base.cols() + j) = calcHinge(hinge, q[i]);
    }
    return X;
}

/// Sum of squares left by the best linear coefficients for these positions: the projected cost.
class ProjectedCost {
public:
    ProjectedCost(const HingeProblem& problem, Eigen::Index at_most) {
        const Eigen::Index stride = std::max<Eigen::Index>(1, problem.q.size() / at_most);
        const Eigen::Index n = (problem.q.size() + stride - 1) / stride;
        base_.resize(n, problem.base.cols());
        q_.resize(n);
        y_.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            base_.row(i) = problem.base.row(i * stride);
            q_[i] = problem.q[i * stride];
            y_[i] = problem.y[i * stride];
        }
    }

    double calc(const std::vector<Hinge>& hinges) const {
        Eigen::MatrixXd X = makeColumns(base_, q_, hinges);
        for (Eigen::Index j = 0; j < X.cols(); ++j) {
            const double norm = X.col(j).norm();
            if (norm > 0) X.col(j) /= norm;
        }
        Eigen::MatrixXd normal = X.transpose() * X;
        normal.diagonal().array() += 1e-12;  // columns without samples
        const Eigen::VectorXd right = X.transpose() * y_;
        return y_.squaredNorm() - right.dot(normal.ldlt().solve(right));
    }

private:
    Eigen::MatrixXd base_;
    Eigen::VectorXd q_, y_;
};

/// Positions worth trying for a hinge: uniform over the part of the range in which it may lie.
std::vector<double> makeGrid(const HingeProblem& problem, int side, bool anywhere, int points) {
    double low = problem.q.minCoeff(), high = problem.q.maxCoeff();
    if (!anywhere && side > 0) low = std::max(low, 0.0);
    if (!anywhere && side < 0) high = std::min(high, 0.0);
    std::vector<double> grid;
    grid.reserve(points);
    for (int i = 0; i < points; ++i) grid.push_back(low + (high - low) * (i + 0.5) / points);
    return grid;
}

/// Coordinate-wise search of the projected cost on grids, from `hinges`.
void searchPositions(const ProjectedCost& cost, const std::vector<std::vector<double>>& grids,
                     std::vector<Hinge>& hinges) {
    double best = cost.calc(hinges);
    for (int sweep = 0; sweep < 6; ++sweep) {
        bool moved = false;
        for (std::size_t j = 0; j < hinges.size(); ++j) {
            auto trial = hinges;
            for (const double position : grids[j]) {
                trial[j].position = position;
                const double value = cost.calc(trial);
                if (value < best * (1 - 1e-12)) {
                    best = value;
                    hinges = trial;
                    moved = true;
                }
            }
        }
        if (!moved) break;
    }
}

/// Columns of the linearised problem: the linear ones and ∂/∂position = −slope beyond the hinge.
Eigen::MatrixXd makeJacobian(const HingeProblem& problem, const std::vector<Hinge>& hinges,
                             const Eigen::VectorXd& slopes) {
    const Eigen::MatrixXd X = makeColumns(problem.base, problem.q, hinges);
    const Eigen::Index m = hinges.size();
    Eigen::MatrixXd J(X.rows(), X.cols() + m);
    J.leftCols(X.cols()) = X;
    for (Eigen::Index j = 0; j < m; ++j) {
        for (Eigen::Index i = 0; i < X.rows(); ++i)
            J(i, X.cols() + j) = X(i, problem.base.cols() + j) != 0 ? -slopes[j] : 0.0;
    }
    return J;
}

/// Gauss–Newton on the projected problem, steps halved until the cost falls.
void refinePositions(const HingeProblem& problem, const ProjectedCost& cost, std::vector<Hinge>& hinges,
                     bool anywhere) {
    const Eigen::Index m = hinges.size();
    const double range = problem.q.maxCoeff() - problem.q.minCoeff();
    double now = cost.calc(hinges);
    for (int iteration = 0; iteration < 40; ++iteration) {
        const Eigen::MatrixXd X = makeColumns(problem.base, problem.q, hinges);
        const Eigen::VectorXd linear = X.completeOrthogonalDecomposition().solve(problem.y);
        const Eigen::MatrixXd J = makeJacobian(problem, hinges, linear.tail(m));
        const Eigen::VectorXd step =
            J.completeOrthogonalDecomposition().solve(problem.y - X * linear).tail(m).cwiseMax(-range).cwiseMin(range);
        bool improved = false;
        double length = 1;
        for (int halving = 0; halving < 12 && !improved; ++halving, length *= 0.5) {
            auto trial = hinges;
            bool allowed = true;
            for (Eigen::Index j = 0; j < m; ++j) {
                auto& hinge = trial[j];
                hinge.position += length * step[j];
                allowed = allowed && (anywhere || hinge.side * hinge.position > 0);
            }
            const double value = allowed ? cost.calc(trial) : std::numeric_limits<double>::infinity();
            if (value < now) {
                improved = now - value > 1e-12 * now;
                now = value;
                hinges = trial;
                break;
            }
        }
        if (!improved) break;
    }
}

}  // namespace

HingeFit fitHinges(const HingeProblem& problem, bool anywhere) {
    const ProjectedCost coarse(problem, 2000);
    const ProjectedCost full(problem, problem.q.size());
    const std::size_t m = problem.start.size();
    std::vector<std::vector<double>> grids;
    grids.reserve(m);
    for (const auto& hinge : problem.start) grids.push_back(makeGrid(problem, hinge.side, anywhere, 40));

    // Starts: the given positions, and hinges spread evenly over their range. Two or more hinges can trap each other,
    // so that coordinate searches from different places are needed.
    std::vector<std::vector<Hinge>> starts;
    auto given = problem.start;
    bool complete = true;
    for (const auto& hinge : given) complete = complete && hinge.position != 0;
    if (complete && m > 0) starts.push_back(given);
    for (const double spread : {0.2, 0.5, 0.8}) {
        auto hinges = problem.start;
        for (std::size_t j = 0; j < m; ++j) {
            const double place = m == 1 ? spread : spread * (static_cast<double>(j) + 0.5) / static_cast<double>(m);
            const auto k = static_cast<std::size_t>(place * static_cast<double>(grids[j].size() - 1));
            hinges[j].position = grids[j][k];
        }
        starts.push_back(hinges);
    }
    std::vector<Hinge> best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (auto& hinges : starts) {
        searchPositions(coarse, grids, hinges);
        refinePositions(problem, full, hinges, anywhere);
        const double value = full.calc(hinges);
        if (value < best_cost) {
            best_cost = value;
            best = hinges;
        }
    }
    HingeFit fit;
    fit.hinges = best;
    const Eigen::MatrixXd X = makeColumns(problem.base, problem.q, best);
    const Eigen::VectorXd linear = X.completeOrthogonalDecomposition().solve(problem.y);
    const Eigen::Index hinge_count = m;
    // Linearised at the solution: the sandwich of the whole parameter vector; its change vanishes there.
    const Eigen::MatrixXd J = makeJacobian(problem, best, linear.tail(hinge_count));
    fit.estimates = solveBlocks(J, problem.y - X * linear, problem.run_starts);
    Eigen::VectorXd value(J.cols());
    value << linear, Eigen::VectorXd::Zero(hinge_count);
    for (std::size_t j = 0; j < m; ++j) value[J.cols() - hinge_count + static_cast<Eigen::Index>(j)] = best[j].position;
    fit.estimates.value = value;
    fit.estimates.residual = problem.y - X * linear;
    const double spread = (problem.y.array() - problem.y.mean()).matrix().norm();
    fit.estimates.fraction = spread > 0 ? fit.estimates.residual.norm() / spread : 0.0;
    return fit;
}

}  // namespace wems::identify
