#include "models/periodic/continuation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace wems {
namespace {

constexpr int kMostIterations = 12;
constexpr double kConverged = 1e-9;  // of the typical amplitude

/// Coefficients of the axes whose law adds something along the motion, and the others.
struct Split {
    std::vector<Eigen::Index> active, idle;
    Eigen::MatrixXd columns;  // of the active: G ∂N/∂Q, all rows
};

Split split(const HarmonicBalance& balance, const HarmonicBalance::Linear& linear,
            const HarmonicBalance::Nonlinear& nonlinear) {
    const Eigen::Index each = balance.coefficients();
    Split parts;
    std::vector<Eigen::Index> axes;
    for (Eigen::Index a = 0; a < static_cast<Eigen::Index>(nonlinear.slope.size()); ++a) {
        const bool active = nonlinear.slope[static_cast<std::size_t>(a)].size() > 0;
        if (active) axes.push_back(a);
        for (Eigen::Index c = 0; c < each; ++c) (active ? parts.active : parts.idle).push_back(a * each + c);
    }
    parts.columns.resize(balance.unknowns(), static_cast<Eigen::Index>(parts.active.size()));
    for (std::size_t i = 0; i < axes.size(); ++i)
        parts.columns.middleCols(static_cast<Eigen::Index>(i) * each, each) =
            balance.calcSlopeColumns(linear, nonlinear, axes[i]);
    return parts;
}

}  // namespace

Continuation::Continuation(const HarmonicBalance& balance, const ContinuationSettings& settings)
    : balance_(balance), settings_(settings), frequency_unit_((settings.to - settings.from) / 10), amplitude_unit_(0) {
    // The largest that the linear model moves anywhere in the band.
    constexpr int looks = 50;
    for (int i = 0; i <= looks; ++i) {
        const double f = settings.from * std::pow(settings.to / settings.from, double(i) / looks);
        amplitude_unit_ = std::max(amplitude_unit_, balance.calcLinear(f).excited.cwiseAbs().maxCoeff());
    }
    if (!(amplitude_unit_ > 0)) amplitude_unit_ = 1e-6;  // nothing moves: any unit will do
}

Eigen::VectorXd Continuation::calcResidual(const Eigen::VectorXd& Q, double frequency) const {
    return balance_.calcResidual(balance_.calcLinear(frequency), balance_.calcNonlinear(Q, frequency), Q);
}

Eigen::VectorXd Continuation::differentiateByFrequency(const Eigen::VectorXd& Q, double frequency) const {
    const double step = 1e-6 * frequency;
    return (calcResidual(Q, frequency + step) - calcResidual(Q, frequency - step)) / (2 * step);
}

Continuation::Step Continuation::solveBordered(const HarmonicBalance::Linear& linear,
                                               const HarmonicBalance::Nonlinear& nonlinear,
                                               const Eigen::VectorXd& by_frequency, const CurvePoint& border,
                                               const Eigen::VectorXd& right_Q, double right_f) const {
    const Split parts = split(balance_, linear, nonlinear);
    const auto count = static_cast<Eigen::Index>(parts.active.size());
    const Eigen::VectorXd w = border.along_Q / amplitude_unit_;
    const double w_f = border.along_frequency / frequency_unit_;
    // An idle coefficient follows at once: δ_i = right_i − C_i δ_active − r_i δf.
    Eigen::MatrixXd matrix(count + 1, count + 1);
    Eigen::VectorXd right(count + 1);
    matrix.topLeftCorner(count, count) = parts.columns(parts.active, Eigen::all);
    matrix.topLeftCorner(count, count).diagonal().array() += 1;
    matrix.topRightCorner(count, 1) = by_frequency(parts.active);
    right.head(count) = right_Q(parts.active);
    const Eigen::VectorXd w_idle = w(parts.idle);
    matrix.bottomLeftCorner(1, count) =
        (w(parts.active) - parts.columns(parts.idle, Eigen::all).transpose() * w_idle).transpose();
    matrix(count, count) = w_f - w_idle.dot(by_frequency(parts.idle));
    right[count] = right_f - w_idle.dot(right_Q(parts.idle));
    const Eigen::VectorXd solution = matrix.partialPivLu().solve(right);
    Step step{Eigen::VectorXd(right_Q.size()), solution[count]};
    step.Q(parts.active) = solution.head(count);
    step.Q(parts.idle) = right_Q(parts.idle) - parts.columns(parts.idle, Eigen::all) * solution.head(count) -
                         step.frequency * by_frequency(parts.idle);
    return step;
}

/// @return iterations, or −1 if it does not converge
int Continuation::correct(const CurvePoint& border, CurvePoint& point) const {
    double last = INFINITY;
    for (int i = 1; i <= kMostIterations; ++i) {
        if (!(point.frequency > 0)) return -1;
        const auto linear = balance_.calcLinear(point.frequency);
        const auto nonlinear = balance_.calcNonlinear(point.Q, point.frequency);
        const Eigen::VectorXd residual = balance_.calcResidual(linear, nonlinear, point.Q);
        const double size = residual.cwiseAbs().maxCoeff();
        if (size <= kConverged * amplitude_unit_) return i;
        constexpr double worse = 10;
        if (!(size < worse * last)) return -1;
        last = size;
        const Step step =
            solveBordered(linear, nonlinear, differentiateByFrequency(point.Q, point.frequency), border, -residual, 0);
        point.Q += step.Q;
        point.frequency += step.frequency;
    }
    return -1;
}

bool Continuation::solveAt(double frequency, Eigen::VectorXd& Q) const {
    CurvePoint border, point;  // across the frequency: it stays
    border.along_Q = Eigen::VectorXd::Zero(Q.size());
    border.along_frequency = 1;
    point.Q = Q;
    point.frequency = frequency;
    if (correct(border, point) < 0) return false;
    Q = point.Q;
    return true;
}

void Continuation::setTangent(const CurvePoint& before, CurvePoint& point) const {
    const auto linear = balance_.calcLinear(point.frequency);
    const auto nonlinear = balance_.calcNonlinear(point.Q, point.frequency);
    const Step step = solveBordered(linear, nonlinear, differentiateByFrequency(point.Q, point.frequency), before,
                                    Eigen::VectorXd::Zero(point.Q.size()), 1);
    point.along_Q = step.Q / amplitude_unit_;
    point.along_frequency = step.frequency / frequency_unit_;
    const double length = std::hypot(point.along_Q.norm(), point.along_frequency);
    point.along_Q /= length;
    point.along_frequency /= length;
}

std::string Continuation::follow(const std::function<bool(const CurvePoint&)>& visit) const {
    CurvePoint point;
    point.frequency = settings_.from;
    point.Q = balance_.calcLinearMotion(balance_.calcLinear(settings_.from));
    if (!solveAt(settings_.from, point.Q)) return "no periodic motion was found at the start of the band";
    CurvePoint upwards = point;
    upwards.along_Q = Eigen::VectorXd::Zero(point.Q.size());
    upwards.along_frequency = 1;
    setTangent(upwards, point);

    const double band = (settings_.to - settings_.from) / frequency_unit_;
    const double longest = settings_.longest_step * band, longest_Q = 20 * settings_.longest_step;
    constexpr double shortest = 1e-7, straight = 0.95, growth = 1.6, shrink = 0.5;
    constexpr int quick = 4, slow = 7;
    double step = longest;
    for (int count = 0; count < settings_.most_points; ++count) {
        if (!visit(point)) return {};
        if (point.frequency > settings_.to || (count > 0 && point.frequency < settings_.from)) return {};
        while (true) {
            if (step < shortest) {
                char text[120];
                std::snprintf(text, sizeof text, "the curve could not be followed beyond %.6g Hz", point.frequency);
                return text;
            }
            // No longer than either unit allows.
            const double length = std::min({step, longest / std::max(std::abs(point.along_frequency), 1e-12),
                                            longest_Q / std::max(point.along_Q.cwiseAbs().maxCoeff(), 1e-12)});
            CurvePoint next;
            next.Q = point.Q + length * amplitude_unit_ * point.along_Q;
            next.frequency = point.frequency + length * frequency_unit_ * point.along_frequency;
            const int iterations = correct(point, next);
            if (iterations > 0) {
                setTangent(point, next);
                const double turn = next.along_Q.dot(point.along_Q) + next.along_frequency * point.along_frequency;
                if (turn > straight) {
                    next.length = point.length + std::hypot((next.Q - point.Q).norm() / amplitude_unit_,
                                                            (next.frequency - point.frequency) / frequency_unit_);
                    point = std::move(next);
                    if (iterations <= quick) step = std::min(growth * std::max(step, length), 10 * longest);
                    if (iterations >= slow) step *= shrink;
                    break;
                }
            }
            step = shrink * length;
        }
    }
    return "the curve has more points than are followed";
}

}  // namespace wems
