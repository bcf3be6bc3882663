#include "models/periodic/continuation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
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
        const bool active = nonlinear.slope[a].size() > 0;
        if (active) axes.push_back(a);
        for (Eigen::Index c = 0; c < each; ++c) (active ? parts.active : parts.idle).push_back(a * each + c);
    }
    parts.columns.resize(balance.unknowns(), parts.active.size());
    for (std::size_t i = 0; i < axes.size(); ++i)
        parts.columns.middleCols(static_cast<Eigen::Index>(i) * each, each) =
            balance.calcSlopeColumns(linear, nonlinear, axes[i]);
    return parts;
}

}  // namespace

Continuation::Continuation(const HarmonicBalance& balance, const ContinuationSettings& settings)
    : balance_(balance), settings_(settings), parameter_unit_((settings.to - settings.from) / 10), amplitude_unit_(0) {
    if (settings.at_frequency) {
        fixed_ = balance.calcLinear(*settings.at_frequency);
        amplitude_unit_ = settings.to * fixed_->excited.cwiseAbs().maxCoeff();
    } else {
        // The largest that the linear model moves anywhere in the band.
        constexpr int looks = 50;
        for (int i = 0; i <= looks; ++i) {
            const double f = settings.from * std::pow(settings.to / settings.from, double(i) / looks);
            amplitude_unit_ = std::max(amplitude_unit_, balance.calcLinear(f).excited.cwiseAbs().maxCoeff());
        }
    }
    if (!(amplitude_unit_ > 0)) amplitude_unit_ = 1e-6;  // nothing moves: any unit will do
}

HarmonicBalance::Linear Continuation::linearAt(double parameter) const {
    if (!fixed_) return balance_.calcLinear(parameter);
    HarmonicBalance::Linear linear = *fixed_;
    linear.excited *= parameter;
    return linear;
}

Eigen::VectorXd Continuation::calcResidual(const Eigen::VectorXd& Q, double parameter) const {
    return balance_.calcResidual(linearAt(parameter), balance_.calcNonlinear(Q, frequencyAt(parameter)), Q);
}

Eigen::VectorXd Continuation::differentiateByParameter(const Eigen::VectorXd& Q, double parameter) const {
    if (fixed_) return -balance_.calcLinearMotion(*fixed_);
    const double step = 1e-6 * parameter;
    return (calcResidual(Q, parameter + step) - calcResidual(Q, parameter - step)) / (2 * step);
}

Continuation::Step Continuation::solveBordered(const HarmonicBalance::Linear& linear,
                                               const HarmonicBalance::Nonlinear& nonlinear,
                                               const Eigen::VectorXd& by_parameter, const CurvePoint& border,
                                               const Eigen::VectorXd& right_Q, double right_p) const {
    const Split parts = split(balance_, linear, nonlinear);
    const Eigen::Index count = parts.active.size();
    const Eigen::VectorXd w = border.along_Q / amplitude_unit_;
    const double w_p = border.along_parameter / parameter_unit_;
    // An idle coefficient follows at once: δ_i = right_i − C_i δ_active − r_i δp.
    Eigen::MatrixXd matrix(count + 1, count + 1);
    Eigen::VectorXd right(count + 1);
    matrix.topLeftCorner(count, count) = parts.columns(parts.active, Eigen::all);
    matrix.topLeftCorner(count, count).diagonal().array() += 1;
    matrix.topRightCorner(count, 1) = by_parameter(parts.active);
    right.head(count) = right_Q(parts.active);
    const Eigen::VectorXd w_idle = w(parts.idle);
    matrix.bottomLeftCorner(1, count) =
        (w(parts.active) - parts.columns(parts.idle, Eigen::all).transpose() * w_idle).transpose();
    matrix(count, count) = w_p - w_idle.dot(by_parameter(parts.idle));
    right[count] = right_p - w_idle.dot(right_Q(parts.idle));
    const Eigen::VectorXd solution = matrix.partialPivLu().solve(right);
    Step step{Eigen::VectorXd(right_Q.size()), solution[count]};
    step.Q(parts.active) = solution.head(count);
    step.Q(parts.idle) = right_Q(parts.idle) - parts.columns(parts.idle, Eigen::all) * solution.head(count) -
                         step.parameter * by_parameter(parts.idle);
    return step;
}

/// @return iterations, or −1 if it does not converge
int Continuation::correct(const CurvePoint& border, CurvePoint& point) const {
    double last = INFINITY;
    for (int i = 1; i <= kMostIterations; ++i) {
        if (!(point.parameter > 0)) return -1;
        const auto linear = linearAt(point.parameter);
        const auto nonlinear = balance_.calcNonlinear(point.Q, frequencyAt(point.parameter));
        const Eigen::VectorXd residual = balance_.calcResidual(linear, nonlinear, point.Q);
        const double size = residual.cwiseAbs().maxCoeff();
        if (size <= kConverged * amplitude_unit_) return i;
        constexpr double worse = 10;
        if (!(size < worse * last)) return -1;
        last = size;
        const Step step =
            solveBordered(linear, nonlinear, differentiateByParameter(point.Q, point.parameter), border, -residual, 0);
        point.Q += step.Q;
        point.parameter += step.parameter;
    }
    return -1;
}

bool Continuation::solveAt(double parameter, Eigen::VectorXd& Q) const {
    CurvePoint border, point;  // across the parameter: it stays
    border.along_Q = Eigen::VectorXd::Zero(Q.size());
    border.along_parameter = 1;
    point.Q = Q;
    point.parameter = parameter;
    if (correct(border, point) < 0) return false;
    Q = point.Q;
    return true;
}

void Continuation::setTangent(const CurvePoint& before, CurvePoint& point) const {
    const auto linear = linearAt(point.parameter);
    const auto nonlinear = balance_.calcNonlinear(point.Q, frequencyAt(point.parameter));
    const Step step = solveBordered(linear, nonlinear, differentiateByParameter(point.Q, point.parameter), before,
                                    Eigen::VectorXd::Zero(point.Q.size()), 1);
    point.along_Q = step.Q / amplitude_unit_;
    point.along_parameter = step.parameter / parameter_unit_;
    const double length = std::hypot(point.along_Q.norm(), point.along_parameter);
    point.along_Q /= length;
    point.along_parameter /= length;
}

CurvePoint Continuation::startAt(const Eigen::VectorXd& Q, double parameter) const {
    CurvePoint point, upwards;
    point.Q = upwards.Q = Q;
    point.parameter = upwards.parameter = parameter;
    upwards.along_Q = Eigen::VectorXd::Zero(Q.size());
    upwards.along_parameter = 1;
    setTangent(upwards, point);
    return point;
}

double Continuation::distance(const CurvePoint& a, const CurvePoint& b) const {
    return std::hypot((a.Q - b.Q).norm() / amplitude_unit_, (a.parameter - b.parameter) / parameter_unit_);
}

double Continuation::calcGap(const CurvePoint& a, const CurvePoint& b) const {
    if (!settings_.largest_gap) return 0;
    // Half way, a cubic with these tangents lies beside the chord by an eighth of their difference times its length.
    const double eighth = distance(a, b) / 8;
    const Eigen::VectorXd beside = eighth * amplitude_unit_ * (a.along_Q - b.along_Q);
    const double ahead = eighth * parameter_unit_ * (a.along_parameter - b.along_parameter);
    const double run = b.parameter - a.parameter, tenth = 0.1 * 0.5 * (a.parameter + b.parameter);
    constexpr double smallest = 0.01;  // of the axis that moves most: one that moves less is judged as if it moved so
    const Eigen::Index each = balance_.coefficients(), axes = a.Q.size() / each;
    const auto amplitudeOf = [&](const Eigen::VectorXd& Q, Eigen::Index axis) {
        return Q.segment(axis * each, each).norm();
    };
    const Eigen::VectorXd middle = 0.5 * (a.Q + b.Q) + beside;
    double largest = 1e-300, worst = 0;
    for (Eigen::Index axis = 0; axis < axes; ++axis) largest = std::max(largest, amplitudeOf(middle, axis));
    for (Eigen::Index axis = 0; axis < axes; ++axis) {
        const double from = amplitudeOf(a.Q, axis), rise = amplitudeOf(b.Q, axis) - from;
        const double above = amplitudeOf(middle, axis) - (from + 0.5 * rise);
        const double size = std::max(amplitudeOf(middle, axis), smallest * largest);
        // At the same parameter; where the curve is steep, at the same amplitude.
        const double at_parameter = std::abs(above - ahead / run * rise) / size;
        const double at_amplitude = std::abs(above / rise * run - ahead) / tenth;
        worst = std::max(worst, std::min(at_parameter, at_amplitude));
    }
    return worst / *settings_.largest_gap;
}

bool Continuation::findStart(Eigen::VectorXd& Q) const {
    Q = balance_.calcLinearMotion(linearAt(settings_.from));
    if (solveAt(settings_.from, Q)) return true;
    if (fixed_) return false;
    // Stops are touched already there: up from a level at which none is.
    ContinuationSettings settings;
    settings.from = 0.01;
    settings.to = 1;
    settings.at_frequency = settings_.from;
    const Continuation levels(balance_, settings);
    levels.follow([&Q](const CurvePoint& point) {
        Q = point.Q;
        return true;
    });
    return solveAt(settings_.from, Q);
}

std::string Continuation::follow(const Visit& visit) const {
    Eigen::VectorXd Q;
    if (!findStart(Q)) return "no periodic motion was found at the start of the band";
    return walk(startAt(Q, settings_.from), visit, nullptr);
}

std::string Continuation::followFrom(const Eigen::VectorXd& Q, double parameter, const Visit& visit) const {
    const CurvePoint start = startAt(Q, parameter);
    std::vector<CurvePoint> forth, back;
    const auto collect = [](std::vector<CurvePoint>& points) {
        return [&points](const CurvePoint& point) {
            points.push_back(point);
            return true;
        };
    };
    bool closed = false;
    std::string incomplete = walk(start, collect(forth), &closed);
    if (!closed) {
        CurvePoint turned = start;
        turned.along_Q *= -1;
        turned.along_parameter *= -1;
        const std::string other = walk(turned, collect(back), nullptr);
        if (incomplete.empty()) incomplete = other;
    }
    const double behind = back.empty() ? 0 : back.back().length;
    for (auto point = back.rbegin(); point != back.rend(); ++point) {
        if (point + 1 == back.rend()) break;  // the start, which comes next
        point->length = behind - point->length;
        point->along_Q *= -1;
        point->along_parameter *= -1;
        if (!visit(*point)) return incomplete;
    }
    for (CurvePoint& point : forth) {
        point.length += behind;
        if (!visit(point)) return incomplete;
    }
    return incomplete;
}

std::string Continuation::walk(CurvePoint point, const Visit& visit, bool* closed) const {
    const CurvePoint start = point;
    const double range = (settings_.to - settings_.from) / parameter_unit_;
    const double longest = settings_.longest_step * range, longest_Q = 20 * settings_.longest_step;
    constexpr double shortest = 1e-7, straight = 0.95, growth = 1.6, shrink = 0.5;
    constexpr int quick = 4, slow = 7;
    double step = longest;
    for (int count = 0; count < settings_.most_points; ++count) {
        if (!visit(point)) return {};
        if (point.parameter > settings_.to || (count > 0 && point.parameter < settings_.from)) return {};
        while (true) {
            if (step < shortest) {
                char text[120];
                std::snprintf(text, sizeof text, "the curve could not be followed beyond %.6g %s", point.parameter,
                              fixed_ ? "of the level" : "Hz");
                return text;
            }
            // No longer than either unit allows.
            const double length = std::min({step, longest / std::max(std::abs(point.along_parameter), 1e-12),
                                            longest_Q / std::max(point.along_Q.cwiseAbs().maxCoeff(), 1e-12)});
            CurvePoint next;
            next.Q = point.Q + length * amplitude_unit_ * point.along_Q;
            next.parameter = point.parameter + length * parameter_unit_ * point.along_parameter;
            const int iterations = correct(point, next);
            if (iterations > 0) {
                setTangent(point, next);
                const double turn = next.along_Q.dot(point.along_Q) + next.along_parameter * point.along_parameter;
                const double gap = calcGap(point, next);
                if (turn > straight && gap < 1) {
                    const double covered = distance(next, point);
                    next.length = point.length + covered;
                    // A chord passes the start no farther off than it bends.
                    if (closed != nullptr && count > 3 &&
                        distance(point, start) + distance(start, next) < 1.1 * covered) {
                        *closed = true;
                        CurvePoint end = start;
                        end.length = point.length + distance(point, start);
                        visit(end);
                        return {};
                    }
                    point = std::move(next);
                    // The gap grows with the square of the step; a little is kept in hand.
                    const double allowed = 0.8 / std::sqrt(std::max(gap, 1e-6));
                    if (iterations <= quick)
                        step = std::min(std::min(growth, allowed) * std::max(step, length), 10 * longest);
                    if (iterations >= slow) step *= shrink;
                    break;
                }
            }
            step = shrink * length;
        }
    }
    return "the curve has more points than are followed";
}

namespace {

constexpr double kBeside = 5e-3;  // of a fold's frequency: to both sides of it

/// Curves over the frequency that have been followed.
class KnownCurves {
public:
    explicit KnownCurves(const Continuation& along) : along_(along) {}
    void add(std::vector<CurvePoint> points) { curves_.push_back(std::move(points)); }

    /// Whether Newton's method leads from a curve near (Q, f) to Q.
    bool hold(const Eigen::VectorXd& Q, double frequency) const {
        const double same = 1e-4 * along_.amplitudeUnit();
        for (const auto& points : curves_) {
            double nearest_distance = INFINITY;
            const CurvePoint* nearest = nullptr;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const double apart = std::hypot((points[i].Q - Q).norm() / along_.amplitudeUnit(),
                                                (points[i].parameter - frequency) / along_.parameterUnit());
                if (apart < nearest_distance) {
                    nearest_distance = apart;
                    nearest = &points[i];
                }
                if (i == 0) continue;
                const CurvePoint &a = points[i - 1], &b = points[i];
                if ((a.parameter - frequency) * (b.parameter - frequency) > 0 || a.parameter == b.parameter) continue;
                const double share = (frequency - a.parameter) / (b.parameter - a.parameter);
                if (leadsTo(a.Q + share * (b.Q - a.Q), frequency, Q, same)) return true;
            }
            if (nearest != nullptr && leadsTo(nearest->Q, frequency, Q, same)) return true;
        }
        return false;
    }

private:
    bool leadsTo(Eigen::VectorXd from, double frequency, const Eigen::VectorXd& Q, double same) const {
        return along_.solveAt(frequency, from) && (from - Q).norm() < same;
    }

    const Continuation& along_;
    std::vector<std::vector<CurvePoint>> curves_;
};

/// All motions at the level itself on the level curve of one frequency.
std::vector<Eigen::VectorXd> findMotions(const HarmonicBalance& balance, double frequency, double highest_level) {
    ContinuationSettings settings;
    settings.from = 0.02;
    settings.to = highest_level;
    settings.at_frequency = frequency;
    settings.longest_step = 1.0 / 60;
    settings.most_points = 500;
    const Continuation levels(balance, settings);
    std::vector<Eigen::VectorXd> motions;
    CurvePoint before;
    levels.follow([&](const CurvePoint& now) {
        if (before.Q.size() > 0 && (before.parameter - 1) * (now.parameter - 1) <= 0 &&
            before.parameter != now.parameter) {
            const double share = (1 - before.parameter) / (now.parameter - before.parameter);
            Eigen::VectorXd Q = before.Q + share * (now.Q - before.Q);
            if (levels.solveAt(1, Q)) motions.push_back(std::move(Q));
        }
        before = now;
        return true;
    });
    return motions;
}

}  // namespace

std::vector<DetachedCurve> findDetachedCurves(const HarmonicBalance& balance, const Continuation& along,
                                              const std::vector<CurvePoint>& known, const std::vector<double>& folds,
                                              const DetachedSearch& search) {
    KnownCurves curves(along);
    curves.add(known);
    std::vector<double> looks;
    for (const double fold : folds)
        for (const double f : {fold * (1 - kBeside), fold * (1 + kBeside)}) looks.push_back(f);
    for (int i = 0; i < search.frequencies; ++i)
        looks.push_back(search.from * std::pow(search.to / search.from, (i + 0.5) / search.frequencies));
    std::vector<DetachedCurve> found;
    for (const double f : looks) {
        if (!(f > search.from && f < search.to)) continue;
        for (const Eigen::VectorXd& Q : findMotions(balance, f, search.highest_level)) {
            if (found.size() == search.most_curves || curves.hold(Q, f)) continue;
            DetachedCurve curve;
            curve.incomplete = along.followFrom(Q, f, [&](const CurvePoint& point) {
                curve.points.push_back(point);
                return true;
            });
            curves.add(curve.points);
            found.push_back(std::move(curve));
        }
    }
    return found;
}

}  // namespace wems
