#include "identify/paper/truncated_svd.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>
#include <stdexcept>

namespace wems::identify {
namespace {

double divideVariances(double without, double with) {
    if (with > 0) return without / with;
    return without > 0 ? std::numeric_limits<double>::infinity() : 1.0;
}

/// The columns but `left_out`.
Eigen::MatrixXd dropColumn(const Eigen::MatrixXd& matrix, Eigen::Index left_out) {
    Eigen::MatrixXd rest(matrix.rows(), matrix.cols() - 1);
    rest << matrix.leftCols(left_out), matrix.rightCols(matrix.cols() - 1 - left_out);
    return rest;
}

}  // namespace

int findNumericalRank(const Eigen::VectorXd& singular_values) {
    constexpr double gap = 20;
    const auto count = static_cast<int>(singular_values.size());
    for (int i = 1; i < count; ++i)
        if (!(gap * singular_values(i) > singular_values(i - 1))) return i;
    return count;
}

TruncatedSolution solveTruncated(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, int keep) {
    const Eigen::Index columns = A.cols();
    if (columns < 1 || A.rows() <= columns) throw std::invalid_argument("fewer equations than unknowns");
    // One orthogonal reduction of [A b] serves every least squares problem below, without squaring the condition.
    Eigen::MatrixXd both(A.rows(), columns + 1);
    both << A, b;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(both);
    const Eigen::MatrixXd triangle = qr.matrixQR().topRows(columns + 1).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd R = triangle.leftCols(columns);
    const Eigen::VectorXd c = triangle.col(columns);

    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(R, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& sigma = svd.singularValues();
    TruncatedSolution solution;
    solution.singular_percent = 100 * sigma / std::max(sigma.sum(), std::numeric_limits<double>::min());
    solution.rank = keep > 0 ? std::min(keep, static_cast<int>(columns)) : findNumericalRank(sigma);
    while (solution.rank > 0 && !(sigma(solution.rank - 1) > 0)) --solution.rank;
    solution.x = Eigen::VectorXd::Zero(columns);
    for (int i = 0; i < solution.rank; ++i) solution.x += svd.matrixU().col(i).dot(c) / sigma(i) * svd.matrixV().col(i);

    const Eigen::VectorXd residual = c - R * solution.x;
    const double size = c.norm();
    solution.residual_fraction = size > 0 ? residual.norm() / size : 0;
    solution.confidence.resize(columns);
    solution.confidence_refitted.resize(columns);
    const double least = (c - R * svd.solve(c)).squaredNorm();
    for (Eigen::Index j = 0; j < columns; ++j) {
        solution.confidence(j) =
            divideVariances((residual + R.col(j) * solution.x(j)).squaredNorm(), residual.squaredNorm());
        const Eigen::MatrixXd rest = dropColumn(R, j);
        const double without =
            columns == 1 ? c.squaredNorm() : (c - rest * rest.completeOrthogonalDecomposition().solve(c)).squaredNorm();
        solution.confidence_refitted(j) = divideVariances(without, least);
    }
    return solution;
}

}  // namespace wems::identify
