#include "identify/exact/leftover.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <complex>

#include "identify/problem/mount_equation.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {
namespace {

constexpr double kNear = 0.01;       // s around a contact that belong to it
constexpr double kEnough = 0.7;      // share of the residual that one axis must carry alone
constexpr double kNoticeable = 0.2;  // share of the connection's that an axis must carry to be named
using Vector6c = Eigen::Matrix<std::complex<double>, 6, 1>;

Vector6c valuesAt(const Eigen::Ref<const Eigen::VectorXf>& values, Eigen::Index bin) {
    Vector6c result;
    for (int i = 0; i < 6; ++i)
        result[i] = {static_cast<double>(values[12 * bin + i]), static_cast<double>(values[12 * bin + 6 + i])};
    return result;
}

/// Mean share (0 … 1) of what exceeds the noise that lies in the span of the given directions.
double calcShare(const OpenLoopProblem& problem, const Eigen::VectorXf& residual,
                 const Eigen::Matrix<double, 6, Eigen::Dynamic>& directions) {
    double inside = 0, total = 0;
    const double noise = 2.0 * static_cast<double>(directions.cols());
    for (std::size_t r = 0; r < problem.runs().size(); ++r) {
        const auto& whitening = problem.whitening(r);
        const auto values = residual.segment(problem.offset(r), whitening.mountSize());
        for (Eigen::Index b = 0; b < whitening.binCount(); ++b) {
            const Eigen::Matrix<std::complex<double>, 6, Eigen::Dynamic> span =
                whitening.mountFactor(b) * directions.cast<std::complex<double>>();
            const Vector6c y = valuesAt(values, b);
            const Eigen::VectorXcd right = span.adjoint() * y;
            const Eigen::MatrixXcd normal = span.adjoint() * span;
            inside += right.dot(normal.ldlt().solve(right)).real() - noise;
            total += y.squaredNorm() - 12;
        }
    }
    return total > 0 ? std::clamp(inside / total, 0.0, 1.0) : 0.0;
}

/// Excess over noise of the two equations.
std::pair<double, double> calcExcess(const OpenLoopProblem& problem, const Eigen::VectorXf& residual) {
    std::pair<double, double> excess{0, 0};
    for (std::size_t r = 0; r < problem.runs().size(); ++r) {
        const auto size = problem.whitening(r).mountSize();
        excess.first += residual.segment(problem.offset(r), size).squaredNorm() - static_cast<float>(size);
        if (problem.hasBracket(r))
            excess.second += residual.segment(problem.offset(r) + size, size).squaredNorm() - static_cast<float>(size);
    }
    return excess;
}

}  // namespace

std::vector<PlaceShare> calcPlaceShares(const OpenLoopProblem& problem, const MountModel& model,
                                        const WhiteVector& residual) {
    const Eigen::VectorXf values = problem.removeCalibration(residual);
    std::vector<PlaceShare> places;
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const auto direction = calcAxisDirection(model, static_cast<int>(i), static_cast<int>(a));
            places.push_back({i, a, model.connections[i].name + "." + kAxes[a], calcShare(problem, values, direction)});
        }
    std::stable_sort(places.begin(), places.end(),
                     [](const PlaceShare& a, const PlaceShare& b) { return a.share > b.share; });
    return places;
}

double calcMountExcess(const OpenLoopProblem& problem, const WhiteVector& residual) {
    Eigen::Index size = 0;
    for (std::size_t r = 0; r < problem.runs().size(); ++r) size += problem.whitening(r).mountSize();
    return calcExcess(problem, problem.removeCalibration(residual)).first / static_cast<double>(size);
}

double calcBracketExcess(const OpenLoopProblem& problem, const WhiteVector& residual) {
    Eigen::Index size = 0;
    for (std::size_t r = 0; r < problem.runs().size(); ++r)
        if (problem.hasBracket(r)) size += problem.whitening(r).mountSize();
    if (size == 0) return 0;
    return calcExcess(problem, problem.removeCalibration(residual)).second / static_cast<double>(size);
}

std::vector<double> calcMisfitByFrequency(const OpenLoopProblem& problem, const WhiteVector& residual) {
    const Eigen::VectorXf values = problem.removeCalibration(residual);
    std::vector<double> sum, count;
    for (std::size_t r = 0; r < problem.runs().size(); ++r) {
        const auto& whitening = problem.whitening(r);
        for (Eigen::Index part = 0; part < whitening.size(); part += whitening.mountSize())
            for (Eigen::Index b = 0; b < whitening.binCount(); ++b) {
                const auto band = static_cast<std::size_t>(whitening.frequency(b));
                if (band >= sum.size()) {
                    sum.resize(band + 1, 0.0);
                    count.resize(band + 1, 0.0);
                }
                sum[band] += static_cast<double>(values.segment(problem.offset(r) + part + 12 * b, 12).squaredNorm());
                count[band] += 12;
            }
    }
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= count[i];
    return sum;
}

std::vector<std::string> findRegimes(const OpenLoopProblem& problem, const MountModel& model) {
    double power[2] = {0, 0}, time[2] = {0, 0};
    for (const auto& run : problem.runs()) {
        std::vector<char> contact(run.sampleCount(), 0);
        const int near = static_cast<int>(kNear / run.interval);
        for (Eigen::Index row = 0; row < run.q.rows(); ++row) {
            const auto& law = model.connections[row / 3].axis[row % 3];
            for (const auto& stop : law.stops) {
                const double sign = stop.side == Side::positive ? 1.0 : -1.0;
                for (int k = 0; k < run.sampleCount(); ++k)
                    if (sign * (run.q(row, k) + law.offset) > stop.clearance)
                        for (int j = std::max(0, k - near); j < std::min(run.sampleCount(), k + near + 1); ++j)
                            contact[j] = 1;
            }
        }
        const Eigen::MatrixXd residual = calcMountResidual(run, model);
        for (int k = 0; k < run.sampleCount(); ++k) {
            const int regime = contact[k] != 0 ? 1 : 0;
            power[regime] += run.taper[k] * residual.col(k).head<3>().squaredNorm();
            time[regime] += run.taper[k];
        }
    }
    if (time[1] == 0) return {"free"};
    const double share = power[1] / (power[0] + power[1]);
    const bool denser = time[0] == 0 || power[1] / time[1] > 3 * power[0] / time[0];
    if (share > 0.7 && denser) return {"contact"};
    if (share < 0.3) return {"free"};
    return {"free", "contact"};
}

std::vector<std::string> locateResidual(const OpenLoopProblem& problem, const MountModel& model,
                                        const WhiteVector& residual) {
    std::vector<std::string> places;
    const Eigen::VectorXf values = problem.removeCalibration(residual);
    const auto [mount, bracket] = calcExcess(problem, values);
    if (bracket > 3 * mount) return {"bracket"};
    const auto shares = calcPlaceShares(problem, model, residual);
    if (shares.front().share > kEnough) {
        places.push_back(shares.front().name);
    } else {
        // No axis alone: the connection that carries most.
        std::size_t best = 0;
        double best_share = -1;
        for (std::size_t i = 0; i < model.connections.size(); ++i) {
            Eigen::Matrix<double, 6, Eigen::Dynamic> all(6, 3);
            for (int a = 0; a < 3; ++a) all.col(a) = calcAxisDirection(model, static_cast<int>(i), a);
            const double share = calcShare(problem, values, all);
            if (share > best_share) {
                best_share = share;
                best = i;
            }
        }
        double sum = 0;
        for (const auto& place : shares)
            if (place.connection == best) sum += std::max(0.0, place.share);
        for (const auto& place : shares)
            if (place.connection == best && place.share > kNoticeable * sum) places.push_back(place.name);
    }
    for (const auto& regime : findRegimes(problem, model)) places.push_back(regime);
    return places;
}

}  // namespace wems::identify
