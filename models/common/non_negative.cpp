#include "models/common/non_negative.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>

namespace wems {
namespace {

/// The coefficients of the columns in `free`, the others zero.
Eigen::VectorXd solveFree(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, const std::vector<bool>& free) {
    std::vector<Eigen::Index> places;
    for (std::size_t j = 0; j < free.size(); ++j)
        if (free[j]) places.push_back(j);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(right.size());
    if (places.empty()) return result;
    Eigen::MatrixXd part = gram(places, places);
    // Columns that are alike share their coefficient.
    part.diagonal().array() += 1e-10 * std::max(1e-300, part.diagonal().maxCoeff());
    const Eigen::VectorXd own = right(places), solved = part.ldlt().solve(own);
    result(places) = solved;
    return result;
}

}  // namespace

Eigen::VectorXd solveNonNegative(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                                 const std::vector<bool>& bounded) {
    const std::size_t count = right.size();
    std::vector<bool> free(count);
    for (std::size_t j = 0; j < count; ++j) free[j] = !bounded[j];
    Eigen::VectorXd value = solveFree(gram, right, free);
    const double rounding = 1e-9 * right.cwiseAbs().maxCoeff();
    for (std::size_t round = 0; round < 3 * count; ++round) {
        const Eigen::VectorXd gradient = right - gram * value;
        std::ptrdiff_t best = -1;
        double steepest = rounding;
        for (std::size_t j = 0; j < count; ++j) {
            const double slope = gradient[j];
            if (free[j] || slope <= steepest) continue;
            steepest = slope;
            best = static_cast<std::ptrdiff_t>(j);
        }
        if (best < 0) break;
        free[best] = true;
        for (std::size_t inner = 0; inner <= count; ++inner) {
            const Eigen::VectorXd trial = solveFree(gram, right, free);
            // As far towards it as no coefficient becomes negative; those that reach zero are held there.
            double part = 1;
            for (std::size_t j = 0; j < count; ++j) {
                const Eigen::Index k = j;
                if (free[j] && bounded[j] && trial[k] <= 0) part = std::min(part, value[k] / (value[k] - trial[k]));
            }
            value += part * (trial - value);
            if (part >= 1) break;
            for (std::size_t j = 0; j < count; ++j) {
                const Eigen::Index k = j;
                if (free[j] && bounded[j] && trial[k] <= 0 && value[k] <= 1e-14 * (1 + value.cwiseAbs().maxCoeff())) {
                    value[k] = 0;
                    free[j] = false;
                }
            }
        }
    }
    return value;
}

}  // namespace wems
