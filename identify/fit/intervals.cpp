#include "identify/fit/intervals.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "identify/fit/channel_noise_effect.hpp"
#include "identify/motion/parallel.hpp"

namespace wems::identify {

double studentQuantile95(double degrees_of_freedom) {
    if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::infinity();
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

namespace {

constexpr int kOrder = 12;  // of the autoregressive model: twice the overlap of neighbouring test functions
constexpr int kBlocksPerRun = 100;
constexpr double kGainFreedom = 12;  // degrees of freedom that the scatter of gains is estimated with, at least about

struct Autoregression {
    Eigen::VectorXd coefficients;  // r_n = Σ a_j r_{n−j} + e_n
    double innovation = 0;         // standard deviation of e
};

/// Yule–Walker.
Autoregression fitAutoregression(const Eigen::VectorXd& residual) {
    const int order = std::min<int>(kOrder, static_cast<int>(residual.size()) / 10);
    Eigen::VectorXd covariance(order + 1);
    for (int lag = 0; lag <= order; ++lag)
        covariance(lag) = residual.head(residual.size() - lag).dot(residual.tail(residual.size() - lag)) /
                          static_cast<double>(residual.size());
    Eigen::MatrixXd toeplitz(order, order);
    for (int i = 0; i < order; ++i)
        for (int j = 0; j < order; ++j) toeplitz(i, j) = covariance(std::abs(i - j));
    toeplitz.diagonal().array() += 1e-9 * covariance(0) + 1e-300;
    Autoregression model;
    model.coefficients = toeplitz.llt().solve(covariance.tail(order));
    model.innovation = std::sqrt(std::max(0.0, covariance(0) - model.coefficients.dot(covariance.tail(order))));
    return model;
}

/// Rows 6 n + e of some outputs and, below them, of the outputs that follow, which are filtered already: filters the
/// rows of equation e backwards by its 1/A, in place.
void filterBackwards(RowMatrix& rows, Eigen::Index outputs, const std::vector<Autoregression>& models) {
    const Eigen::Index all = rows.rows() / 6;
    for (Eigen::Index n = outputs - 1; n >= 0; --n)
        for (Eigen::Index e = 0; e < 6; ++e) {
            const Eigen::VectorXd& coefficients = models[e].coefficients;
            auto row = rows.row(6 * n + e);
            for (Eigen::Index lag = 1; lag <= coefficients.size() && n + lag < all; ++lag)
                row.noalias() += coefficients(lag - 1) * rows.row(6 * (n + lag) + e);
        }
}

/// Scores JᵀWr of one run: their sums over blocks, and the covariance that the residual's autocorrelation gives them.
struct RunScores {
    std::vector<Eigen::VectorXd> blocks;
    Eigen::MatrixXd covariance;
};

/// Block by block from the end, as whole sensitivities of long runs would not stay in the processor's cache: the rows
/// coloured to Γ^½ᵀ J are those of J filtered backwards by 1/A and scaled by the innovation.
RunScores calcRunScores(const Solver& solver, const LinearSystem& system, std::size_t run) {
    const Eigen::VectorXd residual = solver.calcResidual(run);
    const int outputs = static_cast<int>(residual.size() / 6);
    std::vector<Autoregression> models;
    Eigen::VectorXd innovation(6);
    for (int e = 0; e < 6; ++e) {
        models.push_back(fitAutoregression(
            Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<6>>(residual.data() + e, outputs)));
        innovation(e) = models.back().innovation;
    }
    const Eigen::MatrixXd columns = solver.makeSensitivityColumns(system);
    const int length = std::max(2 * kOrder, (outputs + kBlocksPerRun - 1) / kBlocksPerRun);
    RunScores scores;
    scores.covariance = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    RowMatrix rows, following(0, columns.cols());
    for (int first = (outputs - 1) / length * length; first >= 0; first -= length) {
        const int count = std::min(length, outputs - first);
        rows.resize(6 * count + following.rows(), columns.cols());
        rows.topRows(6 * count) = solver.equations().apply(run, columns, first, count);
        rows.bottomRows(following.rows()) = following;
        scores.blocks.emplace_back(rows.topRows(6 * count).transpose() * residual.segment(6 * first, 6 * count));
        filterBackwards(rows, count, models);
        following = rows.topRows(6 * std::min(count, kOrder));
        for (int n = 0; n < count; ++n) rows.middleRows<6>(6 * n).array().colwise() *= innovation.array();
        scores.covariance.selfadjointView<Eigen::Lower>().rankUpdate(rows.topRows(6 * count).transpose());
    }
    scores.covariance = Eigen::MatrixXd(scores.covariance.selfadjointView<Eigen::Lower>());
    return scores;
}

}  // namespace

ParameterUncertainty::ParameterUncertainty(const Solver& solver, const LinearSystem& system) {
    const Eigen::Index count = system.parameters.size();
    Eigen::MatrixXd middle = Solver::kPriorWeight * Eigen::MatrixXd::Identity(count, count);
    std::vector<RunScores> pieces(solver.runCount());
    runParallel(pieces.size(), [&](std::size_t r) { pieces[r] = calcRunScores(solver, system, r); });
    std::vector<Eigen::VectorXd> scores;
    for (auto& piece : pieces) {
        middle += piece.covariance;
        std::move(piece.blocks.begin(), piece.blocks.end(), std::back_inserter(scores));
    }
    stationary_ = system.inverse * middle * system.inverse;
    const Eigen::VectorXd wider =
        (calcChannelNoiseVariances(solver, system).array() / stationary_.diagonal().array()).max(1.0).sqrt();
    stationary_ = wider.asDiagonal() * stationary_ * wider.asDiagonal() + system.open;
    influences_.resize(count, scores.size());
    for (std::size_t b = 0; b < scores.size(); ++b) influences_.col(b) = system.inverse * scores[b];
    calibration_ = calcCalibrationEffect(solver, system);
}

double ParameterUncertainty::calcStandardError(const Eigen::VectorXd& combination) const {
    const double stationary = combination.dot(stationary_ * combination);
    const double blocks = (combination.transpose() * influences_).squaredNorm();
    return std::sqrt(std::max({stationary, blocks, 0.0}) +
                     (combination.transpose() * calibration_.influences).squaredNorm());
}

double ParameterUncertainty::calcHalfWidth(const Eigen::VectorXd& combination) const {
    const double stationary = std::sqrt(std::max(0.0, combination.dot(stationary_ * combination)));
    const Eigen::ArrayXd squares = (combination.transpose() * influences_).array().square();
    // Blocks that carry information; of Gaussian sums the fourth moment is three times the squared variance.
    const double blocks = squares.sum(), fourth = squares.square().sum();
    const double degrees_of_freedom = fourth > 0 ? 3 * blocks * blocks / fourth - 1 : 1;
    const double noise = std::max(studentQuantile95(1e6) * stationary,
                                  studentQuantile95(std::max(1.0, degrees_of_freedom)) * std::sqrt(blocks));
    return std::hypot(noise,
                      studentQuantile95(kGainFreedom) * (combination.transpose() * calibration_.influences).norm());
}

Eigen::MatrixXd ParameterUncertainty::makeCovariance() const {
    Eigen::VectorXd inflation(stationary_.rows());
    for (Eigen::Index j = 0; j < inflation.size(); ++j) {
        const double blocks = influences_.row(j).squaredNorm(), stationary = stationary_(j, j);
        inflation(j) = stationary > 0 ? std::sqrt(std::max(1.0, blocks / stationary)) : 1.0;
    }
    return inflation.asDiagonal() * stationary_ * inflation.asDiagonal() +
           calibration_.influences * calibration_.influences.transpose();
}

}  // namespace wems::identify
