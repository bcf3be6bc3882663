#include "models/periodic/detached_curves.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wems {
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
