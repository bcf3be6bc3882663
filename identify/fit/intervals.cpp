#include "identify/fit/intervals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "identify/motion/parallel.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

double studentQuantile95(double degrees_of_freedom) {
    if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::infinity();
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// About M's origin, translation above rotation, at rest.
Matrix6d makeMassMatrix(const MobileBody& body) {
    const Vector3d& c = body.center_of_gravity;
    Matrix3d cross;
    cross << 0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0;
    Matrix6d mass;
    mass << body.mass * Matrix3d::Identity(), -body.mass * cross, body.mass * cross,
        body.inertia - body.mass * cross * cross;
    return mass;
}

/// Responses of one run's residual to gain errors of its channels.
class RunResponse {
public:
    RunResponse(const RunMotion& motion, const MountModel& model, const RunEquations& equations)
        : motion_(motion),
          test_function_(equations.test_function),
          outputs_(equations.outputs),
          mass_(makeMassMatrix(model.body)) {
        const RelativeHistory relative = calcRelativeHistory(motion, model);
        tangent_.resize(relative.q.cols(), relative.q.rows());
        directions_.resize(6, relative.q.cols());
        damping_.resize(relative.q.cols());
        for (Eigen::Index axis = 0; axis < relative.q.cols(); ++axis) {
            const Connection& connection = model.connections[axis / 3];
            const AxisLaw& law = connection.axis.at(axis % 3);
            const AxisForce force(law);
            const Vector3d e = Vector3d::Unit(axis % 3);
            directions_.col(axis) << e, connection.position.cross(e);
            damping_(axis) = law.damping;
            for (Eigen::Index k = 0; k < relative.q.rows(); ++k)
                tangent_(axis, k) = force.calcStaticStiffness(relative.q(k, axis));
        }
    }

    /// Of a channel that decides the displacement of a part (and its acceleration, if `with_mass`): 6 x outputs.
    Eigen::Matrix<double, 6, Eigen::Dynamic> ofDisplacement(const PartMotion& part, const Vector6d& design,
                                                            const Vector6d& shift, double sign, bool with_mass) const {
        const Eigen::RowVectorXd s = project(design, part.p, part.theta), rate = project(design, part.v, part.w);
        Eigen::Matrix<double, 6, Eigen::Dynamic> wrench(6, s.size());
        wrench.setZero();
        for (Eigen::Index axis = 0; axis < directions_.cols(); ++axis) {
            const double share = sign * directions_.col(axis).dot(shift);
            wrench += directions_.col(axis) * (share * (tangent_.row(axis).cwiseProduct(s) + damping_(axis) * rate));
        }
        Eigen::Matrix<double, 6, Eigen::Dynamic> response = average(wrench, test_function_.value());
        if (with_mass) response += mass_ * shift * average(s, test_function_.second());
        return response;
    }

    /// Of a channel that decides the acceleration of the mobile part.
    Eigen::Matrix<double, 6, Eigen::Dynamic> ofAcceleration(const Vector6d& design, const Vector6d& shift) const {
        return mass_ * shift * average(project(design, motion_.mobile.a, motion_.mobile.alpha), test_function_.value());
    }

private:
    static Eigen::RowVectorXd project(const Vector6d& design, const Eigen::Matrix3Xd& linear,
                                      const Eigen::Matrix3Xd& angular) {
        return design.head<3>().transpose() * linear + design.tail<3>().transpose() * angular;
    }

    Eigen::MatrixXd average(const Eigen::MatrixXd& signal, const std::vector<double>& taps) const {
        const Eigen::Map<const Eigen::VectorXd> weights(taps.data(), taps.size());
        Eigen::MatrixXd result(signal.rows(), outputs_);
        for (Eigen::Index n = 0; n < outputs_; ++n)
            result.col(n) = signal.middleCols(n * test_function_.stride(), weights.size()) * weights;
        return result.colwise() - result.rowwise().mean();
    }

    const RunMotion& motion_;
    const TestFunction& test_function_;
    int outputs_;
    Matrix6d mass_;
    Eigen::MatrixXd tangent_;  // axes x samples, N/m
    Eigen::Matrix<double, 6, Eigen::Dynamic> directions_;
    Eigen::VectorXd damping_;
};

}  // namespace

bool hasGainScatter(const RunMotion& run) {
    return run.mobile.displacement_calibration.gain_scatter > 0 ||
           run.mobile.acceleration_calibration.gain_scatter > 0 ||
           run.fixed.displacement_calibration.gain_scatter > 0 || run.fixed.acceleration_calibration.gain_scatter > 0;
}

CalibrationEffect calcCalibrationEffect(const Solver& solver, const LinearSystem& system) {
    CalibrationEffect effect;
    std::map<std::string, Eigen::VectorXd> scores;
    const NormalEquations& equations = solver.equations();
    for (std::size_t r = 0; r < solver.runCount(); ++r) {
        const RunMotion& motion = solver.motions()[r];
        if (!hasGainScatter(motion)) continue;
        const RunResponse response(motion, solver.model(), equations.runs()[r]);
        const RowMatrix sensitivity = solver.calcSensitivity(r, system);
        const auto addChannels = [&](const Calibration& calibration, const auto& calcResponse) {
            if (!(calibration.gain_scatter > 0)) return;
            const Eigen::MatrixXd shifts = calibration.design.completeOrthogonalDecomposition().pseudoInverse();
            for (std::size_t c = 0; c < calibration.channels.size(); ++c) {
                const Eigen::Index k = c;
                const Eigen::MatrixXd change =
                    equations.whitening(r) *
                    calcResponse(Vector6d(calibration.design.row(k).transpose()), Vector6d(shifts.col(k)));
                effect.residual_squares += std::pow(calibration.gain_scatter, 2) * change.squaredNorm();
                const Eigen::VectorXd score =
                    calibration.gain_scatter *
                    (sensitivity.transpose() * Eigen::Map<const Eigen::VectorXd>(change.data(), change.size()));
                auto& sum =
                    scores.try_emplace(calibration.channels[c], Eigen::VectorXd::Zero(score.size())).first->second;
                sum += score;
            }
        };
        const auto displacementOf = [&](const PartMotion& part, double sign, bool with_mass) {
            return [&, sign, with_mass](const Vector6d& design, const Vector6d& shift) {
                return response.ofDisplacement(part, design, shift, sign, with_mass);
            };
        };
        const PartMotion &mobile = motion.mobile, &fixed = motion.fixed;
        addChannels(mobile.displacement_calibration, displacementOf(mobile, 1, !mobile.acceleration_measured));
        addChannels(fixed.displacement_calibration, displacementOf(fixed, -1, false));
        addChannels(mobile.acceleration_calibration, [&](const Vector6d& design, const Vector6d& shift) {
            Eigen::Matrix<double, 6, Eigen::Dynamic> change = response.ofAcceleration(design, shift);
            if (!mobile.displacement_measured) change += response.ofDisplacement(mobile, design, shift, 1, false);
            return change;
        });
        if (!fixed.displacement_measured) addChannels(fixed.acceleration_calibration, displacementOf(fixed, -1, false));
    }
    effect.influences.resize(system.scale.size(), scores.size());
    Eigen::Index column = 0;
    for (const auto& entry : scores) effect.influences.col(column++) = system.inverse * entry.second;
    return effect;
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
    stationary_ = system.inverse * middle * system.inverse + system.open;
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
